/* trace: rays of one view in batches, each traced by itself: what quick pictures are measured against. */
#ifndef DRAW_EYE_EXACT_TRACE_H
#define DRAW_EYE_EXACT_TRACE_H
#include "draw/eye/quick/quick.h"

/* A view in the eye's frame. */
struct scene_look {
	double origin[3];            // of all rays: the camera in the eye's frame
	float cam_from_eye[3][3];
	float slip[2][3];            // as in the view
	const struct scene_level *level;
	const struct scene_lighting *light;
	const struct scene_beams *beams;
	const struct quick_look *quick;  // null: the march goes along the rays
	float soft;                  // half a pixel on the iris, mm: blur of the pupil's margin
	bool textured;
};

/* Colours of n <= BATCH rays from look->origin; dx, dy, dz: unit directions in the eye's frame. A = 1 where the eye is hit. Adds to
 * *iris the number that reached the iris. */
void scene_trace(float rgba[][4], int n, const float *dx, const float *dy, const float *dz, const struct scene *s,
                 const struct scene_look *look, long *iris);

#endif
