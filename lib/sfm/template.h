/* template: a mesh with good faces of its own laid onto the surface that the pictures give. */
#ifndef SFM_TEMPLATE_H
#define SFM_TEMPLATE_H
#include "sfm/head/head.h"

/* Replaces surface (mm, head) by the template laid onto it where that is no farther from the cloud's points: *laid. Both
 * distances are said. A template that is not like the surface is said and passed over; false, err set, where its file
 * cannot be used. */
bool template_lay(bool *laid, struct mesh *surface, const struct cloud_points *cloud, const struct head *head,
                  struct stage *stage, const struct calibrate_options *o, struct err *err);

#endif
