/* dense: the dense cloud of all pictures, from the pairs that are new.
 */
#ifndef SFM_CLOUD_DENSE_H
#define SFM_CLOUD_DENSE_H
#include "sfm/cloud/cloud.h"
#include "sfm/head/head.h"

/* Matches the pairs with a new picture and returns the cloud of all, world. Points that earlier runs added with the same cameras
 * are kept in work/calibrate/cloud.grid. Returns false, err set, when a picture cannot be read. cloud_points_free in any case. */
bool dense_cloud(struct cloud_points *cloud, const struct head *head, const struct views *views, struct stage *stage,
                 const struct calibrate_options *o, struct err *err);

#endif
