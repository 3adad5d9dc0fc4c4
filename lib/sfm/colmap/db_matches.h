/* db_matches: features and matches in COLMAP's database.
 */
#ifndef SFM_COLMAP_DB_MATCHES_H
#define SFM_COLMAP_DB_MATCHES_H
#include "sfm/colmap/db.h"
#include "sfm/match/match.h"

/* The features of a picture; n = 0 where it has none. sfm_features_free. */
bool db_features(struct sfm_features *out, struct db *db, uint32_t image, struct err *err);

struct db_pair {
	uint32_t a, b;  // image_id, a < b
	struct sfm_matches matches;
};

/* Copies cameras, pictures, keypoints and the matches of these pairs into another database at `path` (made by COLMAP, empty), which
 * is then verified beside others. */
bool db_part(struct db *db, const char *path, int n, const struct db_pair pairs[], struct err *err);

/* Copies matches and verified matches from that database into this one. */
bool db_join(struct db *db, const char *path, struct err *err);

/* Counts the pairs with verified matches, and those matches; of the whole database (image 0) or of one picture. */
bool db_checked(int *pairs, long *matches, struct db *db, uint32_t image, struct err *err);

/* Share of the verified pairs that COLMAP classifies as planar or panoramic: a homography explains their matches as well (0..1; 0
 * without pairs). */
bool db_flat_share(double *share, struct db *db, struct err *err);

#endif
