/* features: COLMAP's database and the SIFT features of every picture in it.
 */
#ifndef SFM_FEATURES_H
#define SFM_FEATURES_H
#include "sfm/views.h"

/* Brings the database to these views and extracts the features of those that are new. A damaged database is made anew.
 * views  sorted by their id in the database: those that are new come last; id and is_new are filled
 * grows  out: everything that was in the database is unchanged, pictures were only added
 * Returns false, err set, when COLMAP or SQLite fails. */
bool features_make(bool *grows, struct views *views, struct stage *stage, const struct calibrate_options *o,
                   struct err *err);

#endif
