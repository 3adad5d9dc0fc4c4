/* scene: fixations of somebody who watches a video, by saliency (image/saliency.h) with inhibition of return. */
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

/* Reads the video `rel` (relative to the capture). places: overwritten; scene_places_free in any case.
 * Returns false, err set, when it cannot be read or its frames differ in size. */
bool scene_places(struct animate_places *places, struct stage *stage, const char *rel, const struct scene_conf *conf,
                  struct err *err);
void scene_places_free(struct animate_places *places);

#endif
