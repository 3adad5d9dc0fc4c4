/* scene: where a video draws the eye, one place after the other. */
#ifndef MOTION_SCENE_H
#define MOTION_SCENE_H
#include "base/stage.h"
#include "image/video/video.h"
#include "motion/animate.h"

struct scene_conf {
	struct video_conf video;
	double dwell[2];    // s: mean and sigma of a fixation
	double inhibit;     // radius of inhibition of return, share of the shorter side
	double inhibit_s;   // its decay
	uint64_t seed;
};

/* places: scene_places_free. */
bool scene_places(struct animate_places *places, struct stage *stage, const char *rel, const struct scene_conf *conf,
                  struct err *err);
void scene_places_free(struct animate_places *places);

#endif
