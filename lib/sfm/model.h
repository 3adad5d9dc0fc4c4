/* model: cameras and points from the verified matches, the best model of the mapper's.
 */
#ifndef SFM_MODEL_H
#define SFM_MODEL_H
#include "sfm/views.h"

#define MODEL_DIR CALIBRATE_DIR "/model"

/* Makes the model, or goes on with the one that is kept (work/calibrate/model, sealed).
 * model  out: in COLMAP's own frame and unit, px of the pictures. colmap_free in any case
 * unfit  out: the photographs are at fault, not a program or a file: err says what to photograph instead (advice.h)
 * grows  of features_make: the kept model may be gone on with
 * Returns false, err set, when COLMAP fails, or when the photographs make no model. */
bool model_make(struct colmap_model *model, bool *unfit, const struct views *views, bool grows, struct stage *stage,
                const struct calibrate_options *o, struct err *err);

#endif
