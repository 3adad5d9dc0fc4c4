/* db: COLMAP's SQLite database of cameras, pictures, features and matches, which is kept between runs.
 * All return false, err set (the file, and SQLite's message), when SQLite fails.
 */
#ifndef SFM_COLMAP_DB_H
#define SFM_COLMAP_DB_H
#include "base/err.h"
#include "sfm/colmap/colmap.h"

struct db;

/* Opens an existing database. db_close. */
bool db_open(struct db **db, const char *path, struct err *err);
void db_close(struct db *db);

/* Removes the file, with what SQLite keeps beside it. */
bool db_remove(const char *path, struct err *err);

/* SQLite's quick check. False where the file is damaged, no database, or without COLMAP's tables. */
bool db_is_sound(const char *path);

/* Whether each picture's features stand there: COLMAP goes on where it cannot read one. False, err set (the first), otherwise. */
bool db_featured(const char *path, struct err *err);

struct db_image {
	const char *name;  // of the file below the folder of pictures
	int camera;        // index into the cameras
	uint32_t id;       // out: image_id
	bool is_new;       // out: no model has been made with it
};

/* Brings the tables to these cameras and pictures: others are removed with their features and matches, missing ones are added, in
 * this order.
 * same       out: nothing was removed or changed, only added
 * has_focal  [n_cameras]: the focal length is measured or given, not guessed
 * images     id and is_new are filled */
bool db_sync(bool *same, struct db *db, int n_cameras, const struct colmap_camera cameras[], const bool has_focal[], int n,
             struct db_image images[], struct err *err);

/* Marks all pictures of the database as used in a finished model: from now on they are not new. A run that was interrupted before
 * this is resumed by the next one. */
bool db_done(const char *path, struct err *err);

#endif
