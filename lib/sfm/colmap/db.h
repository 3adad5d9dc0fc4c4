/* db: COLMAP's database, where pictures, features and matches are kept between runs: what is in it is not made again. */
#ifndef SFM_COLMAP_DB_H
#define SFM_COLMAP_DB_H
#include "base/err.h"
#include "sfm/colmap/colmap.h"

struct db;

/* An existing database. db_close. Errors name the file and what SQLite says. */
bool db_open(struct db **db, const char *path, struct err *err);
void db_close(struct db *db);

/* Removes the file, with what SQLite keeps beside it. */
bool db_remove(const char *path, struct err *err);

/* False where SQLite finds the file damaged, or no database at all. */
bool db_is_sound(const char *path);

struct db_image {
	const char *name;  // of the file below the folder of pictures
	int camera;        // index into the cameras
	uint32_t id;       // out: image_id
	bool is_new;       // out: no model has been made with it
};

/* Brings the tables to these pictures: others are removed with all that belongs to them, missing ones are added, in this
 * order. has_focal: the focal length is measured or given, not guessed. *same: cameras and pictures that were there before
 * are as they were, only added to. */
bool db_sync(bool *same, struct db *db, int n_cameras, const struct colmap_camera cameras[], const bool has_focal[], int n,
             struct db_image images[], struct err *err);

/* From here on no picture that is in it now is new: a run that is interrupted before takes up what it lacks when it comes
 * again. */
bool db_done(const char *path, struct err *err);

#endif
