/* clip: what track left in work/skin, as train takes it. */
#ifndef CLIP_H
#define CLIP_H
#include "base/stage.h"
#include "model/train/train.h"

struct clip {
	struct train_clip train;     // its arrays belong to the clip
	struct skin_camera camera;
	char **au_names;             // [train.n_au]
	int *vertices;
	double *time, *g, *confidence;
	struct npy_rows *lids, *skin, *seen;
	long at;                     // row the files stand at
	struct stage *stage;         // for progress
	char *place;
};

/* Files read, relative to the capture; those that are there. Null-terminated, at most 8; owned by the stage. */
void clip_inputs(const char *out[8], int *n, struct stage *stage);

/* expressions: expression.NAME of capture.conf; action units in gaze.csv are named after them, in their order. */
bool clip_load(struct clip *clip, struct stage *stage, const struct opt_each_list *expressions, struct err *err);
void clip_free(struct clip *clip);

#endif
