#ifndef SFM_CLOUD_DENSE_H
#define SFM_CLOUD_DENSE_H
#include "sfm/cloud/cloud.h"
#include "sfm/head/head.h"

/* The dense cloud, world. What earlier runs added with these cameras stays: work/calibrate/cloud.grid. */
bool dense_cloud(struct cloud_points *cloud, const struct head *head, const struct views *views, struct stage *stage,
                 const struct calibrate_options *o, struct err *err);

#endif
