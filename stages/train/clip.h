/* clip: reads a tracked clip from work/skin for the training. */
#ifndef CLIP_H
#define CLIP_H
#include "base/stage.h"
#include "model/train/train.h"

/* An opened clip; lids, skin and confidences are read from their files as train_run asks for them. clip_free. */
struct clip {
	struct train_clip train;     // its arrays belong to the clip
	struct skin_camera camera;
	struct skin_eyes eyes;
	char **au_names;             // [train.n_au]
	int *vertices;
	double *time, *g, *confidence;
	struct npy_rows *lids, *skin, *seen;
	int lids_file;               // which of the two that hold lids
	long at;                     // row that the files are at
	struct stage *stage;         // for progress
	char *place;
};

/* The files that clip_load reads and that exist, relative to the capture. out: n names, which are static. */
void clip_inputs(const char *out[8], int *n, struct stage *stage);

/* Opens and checks the files. clip: overwritten; clip_free, in any case.
 * expressions  expression.NAME of capture.conf; the action units of gaze.csv have these names, in their order
 * Returns false, err set, when a file is missing or does not match the others. */
bool clip_load(struct clip *clip, struct stage *stage, const struct opt_each_list *expressions, struct err *err);
void clip_free(struct clip *clip);

#endif
