#ifndef SFM_MODEL_H
#define SFM_MODEL_H
#include "sfm/calibrate.h"

#define MODEL_DIR CALIBRATE_DIR "/model"

/* One run of COLMAP's mapper; folders relative to the capture. */
struct model_step {
	const char *from;   // a model that is gone on with; null: begun from the matches alone
	const char *to;
	bool fixed;         // the cameras of that model stay where they are
	bool refine;        // lenses are adjusted
	bool adjust_each;   // everything is adjusted with each picture that comes, not now and then
};
bool model_map(struct stage *stage, const struct views *views, const struct model_step *step, const struct calibrate_options *o,
               struct err *err);

/* Why no two pictures could be put together, and what to photograph instead. Always false, err set. */
bool model_advice(const struct views *views, struct stage *stage, struct err *err);

/* Whether nearly all pairs could be pictures of a plane, or from one place: cameras found from those mean nothing. */
bool model_is_flat(bool *flat, struct stage *stage, struct err *err);

/* A line for each picture that is not in the model, and why. */
void model_warn(const struct colmap_model *model, const struct views *views, struct stage *stage);

/* Removes a model's files; dir: relative to the capture. */
void model_remove(struct stage *stage, const char *dir);

#endif
