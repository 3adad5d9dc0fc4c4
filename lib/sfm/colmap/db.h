/* db: COLMAP's database, where pictures, features and matches are kept between runs: what is in it is not made again. */
#ifndef SFM_COLMAP_DB_H
#define SFM_COLMAP_DB_H
#include "base/err.h"
#include "sfm/colmap/colmap.h"
#include "sfm/match/match.h"

struct db;

/* An existing database. db_close. Errors name the file and what SQLite says. */
bool db_open(struct db **db, const char *path, struct err *err);
void db_close(struct db *db);

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

/* Features of a picture; none: n = 0. sfm_features_free. */
bool db_features(struct sfm_features *out, struct db *db, uint32_t image, struct err *err);

/* Whether the pair has been compared and checked before. */
bool db_has_pair(bool *has, struct db *db, uint32_t a, uint32_t b, struct err *err);

struct db_pair {
	uint32_t a, b;  // image_id, a < b
	struct sfm_matches matches;
};

/* Copies cameras, pictures, points and the matches of these pairs into a database of their own at `path` (made by COLMAP,
 * empty), to be checked beside others. */
bool db_part(struct db *db, const char *path, int n, const struct db_pair pairs[], struct err *err);

/* Takes the checked matches of that database over. */
bool db_join(struct db *db, const char *path, struct err *err);

/* Pairs with checked matches, and how many of them there are; for the whole database (image 0) or of one picture. */
bool db_checked(int *pairs, long *matches, struct db *db, uint32_t image, struct err *err);

/* Share of checked pairs whose matches a plane, or a camera that only turned, explains as well (0..1; 0 without pairs). */
bool db_flat_share(double *share, struct db *db, struct err *err);

#endif
