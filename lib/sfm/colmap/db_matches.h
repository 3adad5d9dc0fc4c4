/* db_matches: features and matches in COLMAP's database.
 */
#ifndef SFM_COLMAP_DB_MATCHES_H
#define SFM_COLMAP_DB_MATCHES_H
#include "sfm/colmap/db.h"
#include "sfm/match/match.h"

/* Features of a picture; none: n = 0. sfm_features_free. */
bool db_features(struct sfm_features *out, struct db *db, uint32_t image, struct err *err);

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
