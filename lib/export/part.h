/* part: a triangle mesh of an eye that leaves for other programs.
 * Frame  glTF's: x right as the camera sees the eye, y up, z out of the eye along its axis; the origin is the centre of the scleral
 *        sphere, about which an eye turns. mm here, metres in files. */
#ifndef EXPORT_PART_H
#define EXPORT_PART_H
#include <stdint.h>

#include "draw/eye/scene.h"

enum { EXPORT_TARGETS = 2 };

struct export_part {
	int n, n_corners;
	float (*x)[3], (*normal)[3], (*uv)[2];
	float (*tangent)[4];                     // direction of rising u, handedness in w; null: no normal map
	uint32_t *corner;                        // three a triangle, counter-clockwise seen from outside
	float (*target[EXPORT_TARGETS])[3];      // displacements of morph targets; null: none
};

void export_part_free(struct export_part *part);

/* Grid of rings [rings][around], closed round; its triangles. Triangles without area at a pole (the whole first or last ring in one
 * point) are left out. The caller fills x, normal and uv, and allocates the rest if needed. */
struct export_part export_grid(int rings, int around, bool pole_first, bool pole_last);

/* Between the eye's frame (lib/README.md) and a part's: a point; a direction. */
static inline void export_point(float out[3], const struct scene *s, const double eye[3])
{
	out[0] = (float)eye[0];
	out[1] = (float)-eye[1];
	out[2] = (float)(s->sclera_z - eye[2]);
}
static inline void export_direction(float out[3], const double eye[3])
{
	out[0] = (float)eye[0];
	out[1] = (float)-eye[1];
	out[2] = (float)-eye[2];
}

#endif
