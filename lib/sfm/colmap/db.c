#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "sfm/colmap/db_impl.h"

static bool sql_error(struct db *db, struct err *err)
{
	int code = sqlite3_errcode(db->sql);
	return err_set(err, "%s: %s", db->path, code == SQLITE_FULL ? "the disk is full" : sqlite3_errmsg(db->sql));
}

bool db_run(struct db *db, const char *text, struct err *err)
{
	return sqlite3_exec(db->sql, text, 0, 0, 0) == SQLITE_OK || sql_error(db, err);
}

sqlite3_stmt *db_prepare(struct db *db, const char *text, struct err *err)
{
	sqlite3_stmt *s = 0;
	if (sqlite3_prepare_v2(db->sql, text, -1, &s, 0) != SQLITE_OK)
		sql_error(db, err);
	return s;
}

bool db_finish(struct db *db, sqlite3_stmt *s, struct err *err)
{
	bool ok = s && sqlite3_step(s) == SQLITE_DONE;
	if (s && !ok)
		sql_error(db, err);
	sqlite3_finalize(s);
	return ok;
}

bool db_open(struct db **out, const char *path, struct err *err)
{
	struct db *db = mem_new(1, sizeof *db);
	db->path = mem_str(path);
	*out = db;
	db_gate();
	if (sqlite3_open_v2(path, &db->sql, SQLITE_OPEN_READWRITE, 0) != SQLITE_OK || !db_run(db, "PRAGMA foreign_keys=OFF", err)) {
		sql_error(db, err);
		db_close(db);
		*out = 0;
		return false;
	}
	return true;
}

void db_close(struct db *db)
{
	if (!db)
		return;
	sqlite3_close(db->sql);
	free(db->path);
	free(db);
}

bool db_remove(const char *path, struct err *err)
{
	// SQLite's journals belong to the database that is removed; left behind they would be applied to the next one.
	static const char *const ends[] = { "", "-wal", "-shm", "-journal" };
	bool ok = true;
	for (int i = 0; i < COUNT(ends); i++) {
		char *file = mem_printf("%s%s", path, ends[i]);
		ok = file_remove(file, err) && ok;
		free(file);
	}
	return ok;
}

/* Integer of the first row's first column; `none` where there is no row. */
static bool number(int64_t *out, int64_t none, struct db *db, sqlite3_stmt *s, struct err *err)
{
	int step = s ? sqlite3_step(s) : SQLITE_ERROR;
	*out = step == SQLITE_ROW ? sqlite3_column_int64(s, 0) : none;
	bool ok = step == SQLITE_ROW || step == SQLITE_DONE;
	if (s && !ok)
		sql_error(db, err);
	sqlite3_finalize(s);
	return ok;
}

bool db_is_sound(const char *path)
{
	struct db *db = 0;
	struct err none = { 0 };
	bool ok = db_open(&db, path, &none);
	sqlite3_stmt *s = ok ? db_prepare(db, "PRAGMA quick_check(1)", &none) : 0;
	const char *says = s && sqlite3_step(s) == SQLITE_ROW ? (const char *)sqlite3_column_text(s, 0) : 0;
	ok = says && !strcmp(says, "ok");
	sqlite3_finalize(s);
	// Where COLMAP was interrupted as it made the file, the file is whole and tables are missing.
	int64_t tables = 0;
	ok = ok
	     && number(&tables, 0, db, db_prepare(db, "SELECT count(*) FROM sqlite_master WHERE type='table' AND name IN ('cameras','images','keypoints',"
	                                              "'descriptors','matches','two_view_geometries')", &none), &none)
	     && tables == 6;
	db_close(db);
	return ok;
}

bool db_featured(const char *path, struct err *err)
{
	struct db *db = 0;
	if (!db_open(&db, path, err))
		return false;
	sqlite3_stmt *s = db_prepare(db, "SELECT name FROM images WHERE image_id NOT IN (SELECT image_id FROM keypoints) ORDER BY image_id", err);
	const int step = s ? sqlite3_step(s) : SQLITE_ERROR;
	bool ok = step == SQLITE_DONE;
	if (step == SQLITE_ROW)
		err_set(err, "%s: has no features of %s: COLMAP could not read it; colmap.log says why", path, (const char *)sqlite3_column_text(s, 0));
	else if (s && !ok)
		sql_error(db, err);
	sqlite3_finalize(s);
	db_close(db);
	return ok;
}

static bool remove_image(struct db *db, int64_t id, struct err *err)
{
	static const char *const text[] = {
		"DELETE FROM keypoints WHERE image_id=?1", "DELETE FROM descriptors WHERE image_id=?1",
		"DELETE FROM images WHERE image_id=?1", "DELETE FROM " DB_DONE " WHERE image_id=?1",
		"DELETE FROM matches WHERE pair_id/2147483647=?1 OR pair_id%2147483647=?1",
		"DELETE FROM two_view_geometries WHERE pair_id/2147483647=?1 OR pair_id%2147483647=?1",
	};
	for (int i = 0; i < COUNT(text); i++) {
		sqlite3_stmt *s = db_prepare(db, text[i], err);
		if (s)
			sqlite3_bind_int64(s, 1, id);
		if (!db_finish(db, s, err))
			return false;
	}
	return true;
}

/* Removes the pictures that are not in the list. any: out, whether there were some. */
static bool remove_gone(bool *any, struct db *db, int n, const struct db_image images[], struct err *err)
{
	int64_t *gone = 0;
	int n_gone = 0;
	sqlite3_stmt *s = db_prepare(db, "SELECT image_id,name FROM images ORDER BY image_id", err);
	while (s && sqlite3_step(s) == SQLITE_ROW) {
		const char *name = (const char *)sqlite3_column_text(s, 1);
		bool stays = false;
		for (int i = 0; i < n && !stays; i++)
			stays = name && !strcmp(name, images[i].name);
		if (stays)
			continue;
		gone = mem_grow(gone, (size_t)n_gone + 1, sizeof *gone);
		gone[n_gone++] = sqlite3_column_int64(s, 0);
	}
	sqlite3_finalize(s);
	bool ok = s != 0;
	for (int i = 0; i < n_gone && ok; i++)
		ok = remove_image(db, gone[i], err);
	*any = n_gone > 0;
	free(gone);
	return ok;
}

/* Writes camera k, of id k + 1. changed: set where the database held another one. */
static bool put_camera(bool *changed, struct db *db, int k, const struct colmap_camera *c, bool has_focal, struct err *err)
{
	size_t bytes = sizeof(double) * (size_t)colmap_kind_params(c->kind);
	sqlite3_stmt *s = db_prepare(db, "SELECT model,width,height,params,prior_focal_length FROM cameras WHERE camera_id=?1", err);
	if (!s)
		return false;
	sqlite3_bind_int(s, 1, k + 1);
	bool there = sqlite3_step(s) == SQLITE_ROW;
	bool same = there && sqlite3_column_int(s, 0) == (int)c->kind && sqlite3_column_int(s, 1) == c->width
	            && sqlite3_column_int(s, 2) == c->height && sqlite3_column_bytes(s, 3) == (int)bytes
	            && !memcmp(sqlite3_column_blob(s, 3), c->params, bytes) && sqlite3_column_int(s, 4) == has_focal;
	sqlite3_finalize(s);
	*changed |= there && !same;
	if (same)
		return true;
	s = db_prepare(db, "INSERT OR REPLACE INTO cameras VALUES(?1,?2,?3,?4,?5,?6)", err);
	if (!s)
		return false;
	sqlite3_bind_int(s, 1, k + 1);
	sqlite3_bind_int(s, 2, (int)c->kind);
	sqlite3_bind_int(s, 3, c->width);
	sqlite3_bind_int(s, 4, c->height);
	sqlite3_bind_blob(s, 5, c->params, (int)bytes, SQLITE_STATIC);
	sqlite3_bind_int(s, 6, has_focal);
	return db_finish(db, s, err);
}

static bool put_image(bool *changed, struct db *db, struct db_image *image, struct err *err)
{
	int64_t id, camera, rows;
	sqlite3_stmt *s = db_prepare(db, "SELECT image_id FROM images WHERE name=?1", err);
	if (s)
		sqlite3_bind_text(s, 1, image->name, -1, SQLITE_STATIC);
	if (!number(&id, 0, db, s, err))
		return false;
	if (!id) {
		s = db_prepare(db, "INSERT INTO images(name,camera_id) VALUES(?1,?2)", err);
		if (s) {
			sqlite3_bind_text(s, 1, image->name, -1, SQLITE_STATIC);
			sqlite3_bind_int(s, 2, image->camera + 1);
		}
		if (!db_finish(db, s, err))
			return false;
		image->id = (uint32_t)sqlite3_last_insert_rowid(db->sql);
		image->is_new = true;
		return true;
	}
	image->id = (uint32_t)id;
	s = db_prepare(db, "SELECT camera_id FROM images WHERE image_id=?1", err);
	if (s)
		sqlite3_bind_int64(s, 1, id);
	if (!number(&camera, 0, db, s, err))
		return false;
	*changed |= camera != image->camera + 1;
	s = db_prepare(db, "UPDATE images SET camera_id=?2 WHERE image_id=?1", err);
	if (s) {
		sqlite3_bind_int64(s, 1, id);
		sqlite3_bind_int(s, 2, image->camera + 1);
	}
	if (!db_finish(db, s, err))
		return false;
	s = db_prepare(db, "SELECT count(*) FROM " DB_DONE " WHERE image_id=?1", err);
	if (s)
		sqlite3_bind_int64(s, 1, id);
	if (!number(&rows, 0, db, s, err))
		return false;
	image->is_new = !rows;
	return true;
}

bool db_sync(bool *same, struct db *db, int n_cameras, const struct colmap_camera cameras[], const bool has_focal[], int n,
             struct db_image images[], struct err *err)
{
	bool gone = false, changed = false;
	bool ok = db_run(db, "BEGIN; CREATE TABLE IF NOT EXISTS " DB_DONE "(image_id INTEGER PRIMARY KEY)", err)
	          && remove_gone(&gone, db, n, images, err);
	for (int k = 0; k < n_cameras && ok; k++)
		ok = put_camera(&changed, db, k, &cameras[k], has_focal[k], err);
	for (int i = 0; i < n && ok; i++)
		ok = put_image(&changed, db, &images[i], err);
	*same = !gone && !changed;
	return ok && db_run(db, "COMMIT", err);
}

bool db_done(const char *path, struct err *err)
{
	struct db *db;
	bool ok = db_open(&db, path, err) && db_run(db, "INSERT OR IGNORE INTO " DB_DONE " SELECT image_id FROM images", err);
	db_close(db);
	return ok;
}
