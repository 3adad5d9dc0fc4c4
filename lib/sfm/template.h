/* template: a mesh with good faces of its own, registered to the surface that the pictures give.
 */
#ifndef SFM_TEMPLATE_H
#define SFM_TEMPLATE_H
#include "sfm/head/head.h"

/* Registers the template of o->template to the surface (non-rigid ICP, register/transfer.h) and keeps the result where the cloud's
 * points lie at most template_cells cells farther from it than from the surface.
 * laid     out: surface has been replaced by the registered template, without colours
 * surface  mm, head's frame
 * cloud    world of head->model
 * Both median distances are logged. A template that cannot be registered is recorded as skipped. Returns false, err set, when its
 * file cannot be used. */
bool template_lay(bool *laid, struct mesh *surface, const struct cloud_points *cloud, const struct head *head,
                  struct stage *stage, const struct calibrate_options *o, struct err *err);

#endif
