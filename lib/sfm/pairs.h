/* pairs: which pictures are compared, their matches, and the geometric verification of those.
 */
#ifndef SFM_PAIRS_H
#define SFM_PAIRS_H
#include "sfm/views.h"

/* Selects overlapping pairs with a new picture in them, matches their features, and has COLMAP verify the matches by the
 * epipolar geometry of two views (RANSAC); the result stands in the database. Nothing is done where no view is new.
 * Returns false, err set, when COLMAP or SQLite fails. */
bool pairs_match(const struct views *views, struct stage *stage, const struct calibrate_options *o, struct err *err);

#endif
