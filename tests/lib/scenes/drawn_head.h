/* drawn_head: photographs of a head whose eyes and size are known, by casting rays at the bundled MakeHuman head; skin, lips,
 * brows and eyes painted on. Shares nothing with the program's own renderer.
 * Frame: the mesh's, mm: x to the head's left, y up, z out of the face.
 */
#ifndef TESTS_DRAWN_HEAD_H
#define TESTS_DRAWN_HEAD_H
#include "mesh/mesh.h"
#include "mesh/ray.h"

/* Centres of the left and the right eyeball; the iris's disc, 5.85 mm wide, stands 13 mm before. */
static const double drawn_head_ball[2][3] = { { 30.8, 728.4, 124.5 }, { -30.8, 728.4, 124.5 } };
#define DRAWN_HEAD_IRIS 5.85

struct drawn_head {
	struct mesh mesh;
	struct ray_scene *scene;
};

/* samples/face/targets/mpfb.obj. drawn_head_free. */
bool drawn_head_load(struct drawn_head *head, struct err *err);
void drawn_head_free(struct drawn_head *head);

/* cam_from_head of a camera so many mm before the middle of the face, gone round it by yaw and up by pitch, rad. */
void drawn_head_camera(double R[3][3], double t[3], double yaw, double pitch, double distance);

/* rgb[height][width][3], sRGB; principal point in the middle. */
void drawn_head_draw(uint8_t *rgb, const struct drawn_head *head, const double R[3][3], const double t[3], double focal_px, int width, int height);

#endif
