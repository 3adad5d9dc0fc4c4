#include "sfm/colmap/db_matches.h"

#include <math.h>
#include <sqlite3.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "sfm/colmap/db_impl.h"

static int64_t key_of(uint32_t a, uint32_t b)
{
	return (int64_t)(a < b ? a : b) * 2147483647 + (a < b ? b : a);
}

/* A table's matrix of one picture: rows × cols values of `size` bytes. Borrowed until the statement ends; null: none. */
static const void *matrix(int *rows, int *cols, sqlite3_stmt *s, uint32_t image, size_t size)
{
	*rows = *cols = 0;
	sqlite3_bind_int64(s, 1, image);
	if (sqlite3_step(s) != SQLITE_ROW)
		return 0;
	int r = sqlite3_column_int(s, 0), c = sqlite3_column_int(s, 1);
	if (r < 0 || c < 0 || r > 1 << 24 || c > 1 << 10 || sqlite3_column_bytes(s, 2) != (int64_t)r * c * (int64_t)size)
		return 0;
	*rows = r;
	*cols = c;
	return sqlite3_column_blob(s, 2);
}

bool db_features(struct sfm_features *out, struct db *db, uint32_t image, struct err *err)
{
	int n, cols, n_key, key_cols;
	*out = (struct sfm_features){ 0 };
	sqlite3_stmt *d = db_prepare(db, "SELECT rows,cols,data FROM descriptors WHERE image_id=?1", err),
	             *k = db_prepare(db, "SELECT rows,cols,data FROM keypoints WHERE image_id=?1", err);
	bool ok = d && k;
	if (ok) {
		const void *bytes = matrix(&n, &cols, d, image, 1);
		const float *keys = matrix(&n_key, &key_cols, k, image, sizeof(float));
		if (n && (cols != SIFT_DIM || n_key != n || (key_cols != 4 && key_cols != 6)))
			ok = err_set(err, "%s: features of picture %u are not SIFT's", db->path, image);
		else if (n && bytes && keys) {
			out->n = n;
			out->descriptors = mem_array((size_t)n, SIFT_DIM);
			out->scale = mem_array((size_t)n, sizeof(float));
			memcpy(out->descriptors, bytes, (size_t)n * SIFT_DIM);
			// x y scale orientation, or x y and the affine shape a11 a12 a21 a22.
			for (int i = 0; i < n; i++)
				out->scale[i] = key_cols == 4 ? keys[4 * i + 2] : hypotf(keys[6 * i + 2], keys[6 * i + 4]);
		}
	}
	sqlite3_finalize(d);
	sqlite3_finalize(k);
	return ok;
}

static bool put_matches(struct db *db, const struct db_pair *pair, struct err *err)
{
	sqlite3_stmt *s = db_prepare(db, "INSERT OR REPLACE INTO matches VALUES(?1,?2,2,?3)", err);
	if (!s)
		return false;
	sqlite3_bind_int64(s, 1, key_of(pair->a, pair->b));
	sqlite3_bind_int(s, 2, pair->matches.n);
	sqlite3_bind_blob(s, 3, pair->matches.index, (int)sizeof *pair->matches.index * pair->matches.n, SQLITE_STATIC);
	return db_finish(db, s, err);
}

static bool attach(struct db *db, const char *path, struct err *err)
{
	sqlite3_stmt *s = db_prepare(db, "ATTACH DATABASE ?1 AS part", err);
	if (s)
		sqlite3_bind_text(s, 1, path, -1, SQLITE_STATIC);
	return db_finish(db, s, err);
}

bool db_part(struct db *db, const char *path, int n, const struct db_pair pairs[], struct err *err)
{
	struct db *part;
	if (!attach(db, path, err))
		return false;
	bool ok = db_run(db, "BEGIN; INSERT INTO part.cameras SELECT * FROM main.cameras; INSERT INTO part.images SELECT * FROM "
	                     "main.images; INSERT INTO part.keypoints SELECT * FROM main.keypoints; COMMIT; DETACH part", err)
	          && db_open(&part, path, err);
	if (!ok)
		return false;
	ok = db_run(part, "BEGIN", err);
	for (int i = 0; i < n && ok; i++)
		ok = put_matches(part, &pairs[i], err);
	ok = ok && db_run(part, "COMMIT", err);
	db_close(part);
	return ok;
}

bool db_join(struct db *db, const char *path, struct err *err)
{
	return attach(db, path, err)
	       && db_run(db, "BEGIN; INSERT OR REPLACE INTO main.two_view_geometries SELECT * FROM part.two_view_geometries; "
	                     "INSERT OR REPLACE INTO main.matches SELECT * FROM part.matches; COMMIT; DETACH part", err);
}

bool db_checked(int *pairs, long *matches, struct db *db, uint32_t image, struct err *err)
{
	sqlite3_stmt *s = db_prepare(db, "SELECT count(*),total(rows) FROM two_view_geometries WHERE rows>0 AND "
	                                 "(?1=0 OR pair_id/2147483647=?1 OR pair_id%2147483647=?1)", err);
	if (!s)
		return false;
	sqlite3_bind_int64(s, 1, image);
	bool ok = sqlite3_step(s) == SQLITE_ROW;
	*pairs = ok ? sqlite3_column_int(s, 0) : 0;
	*matches = ok ? (long)sqlite3_column_double(s, 1) : 0;
	sqlite3_finalize(s);
	return ok;
}

bool db_flat_share(double *share, struct db *db, struct err *err)
{
	// COLMAP's estimators/two_view_geometry.h: 4 planar, 5 panoramic, 6 one of the two.
	sqlite3_stmt *s = db_prepare(db, "SELECT total(config BETWEEN 4 AND 6)/max(1,count(*)) FROM two_view_geometries WHERE rows>0", err);
	if (!s)
		return false;
	*share = sqlite3_step(s) == SQLITE_ROW ? sqlite3_column_double(s, 0) : 0;
	sqlite3_finalize(s);
	return true;
}
