/* lid_scene: an eye's opening on the screen with a known distance to its lids, and the distance transforms that the
 * project's own is compared with. */
#ifndef TESTS_LID_SCENE_H
#define TESTS_LID_SCENE_H
#include "image/distance/distance.h"

struct lid_scene {
	struct distance_scene scene;  // points into what follows
	uint8_t *material;
	float *coverage, *depth;
	double radius[2], center[2][2];  // px: the lids are arcs of two circles, the opening lies inside both
};

/* An opening of wide x high px in the middle of a screen, its corners level, its two arcs unlike; the upper one is
 * `lean` (-0.4 to 0.4) of the height lower than in the middle. Coverage by 8 x 8 samples a pixel. free: lid_scene_free. */
void lid_scene_make(struct lid_scene *lids, int width, int height, double wide, double high, double lean);
void lid_scene_free(struct lid_scene *lids);

/* True distance in px of a point of the opening to the lids: a disc fits into both circles or it does not. */
double lid_scene_distance(const struct lid_scene *lids, double x, double y);

/* Felzenszwalb and Huttenlocher 2012: the exact transform of the whole screen, px between texel centres. */
void peer_exact(float *out, const struct distance_scene *scene);

/* Jump flooding (Rong and Tan 2006) with one more round of step 1, px. */
void peer_jump(float *out, const struct distance_scene *scene, struct distance_cost *cost);

#endif
