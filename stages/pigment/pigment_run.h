/* pigment_run: white, then pigment and relief in turn, as the iris paper's section 4 has it, until it stops paying. */
#ifndef STAGES_PIGMENT_RUN_H
#define STAGES_PIGMENT_RUN_H
#include "stages/pigment/pigment_stage.h"

enum { PIGMENT_ROUNDS_MAX = 10 };

struct pigment_run {
	const struct capture *capture;
	int eye;
	struct stage *stage;
	const struct eye *anatomy;
	struct image clean, thickness;  // owned
	double extent;
	struct pupil pupil;
	/* results */
	struct pigment_conf conf;       // as used: the view's cosine, the exposure's prior
	struct white white;
	const char *white_photo;        // its NAME; null: none
	struct pigment_classes classes;
	struct pigment_fit fit;
	int rounds;
	double residual[PIGMENT_ROUNDS_MAX], relief[PIGMENT_ROUNDS_MAX];  // relative; rms ln luminance
	char note[256];
};

bool pigment_run(struct pigment_run *run, const struct pigment_stage_conf *conf, struct err *err);
void pigment_run_free(struct pigment_run *run);

#endif
