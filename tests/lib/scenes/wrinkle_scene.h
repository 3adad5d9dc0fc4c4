/* wrinkle_scene: a skin of known relief: a ball with grooves of known place, width and depth, lit by a sky that its relief hides
 * (rays over the height field, no 2D valley) and by a lamp, moved, patterned, with a mole and a brow, photographed with noise. */
#ifndef TESTS_WRINKLE_SCENE_H
#define TESTS_WRINKLE_SCENE_H
#include "track/wrinkle/wrinkle.h"

enum { SCENE_W = 440, SCENE_H = 300, SCENE_FRAMES = 3, GROOVES = 3 };

static const double scene_ball = 90, scene_away = 400, scene_focal = 3400;  // mm, mm, px: 8.5 px a mm where it is nearest

/* An arc of a circle (mm, head's x and y), from one angle to another; d and w of its groove. */
struct groove {
	double center[2], radius, from, to, depth, width;
};
extern const struct groove scene_grooves[GROOVES];

/* Height of the relief, mm, at the head's x and y. */
double scene_height(double x, double y, double strength);

struct scene_light {
	double sky, lamp[3];
};

struct scene {
	uint8_t *grey[SCENE_FRAMES], *mask;
	float (*at[SCENE_FRAMES])[2], *confidence;
	double (*ref)[2];
	struct mesh mesh;
	float (*normals)[3];
	struct ray_scene *rays;
	struct wrinkle_ground ground;
	struct wrinkle_frame frame[SCENE_FRAMES];  // no relief, half of it, all of it
};

void scene_open(struct scene *scene, double strength, const struct scene_light *light);
void scene_close(struct scene *scene);

#endif
