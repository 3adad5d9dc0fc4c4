/* scene_trace: rays of one view, in batches; between view.c, draw/eye/colour.c and trace.c. */
#ifndef DRAW_EYE_EXACT_TRACE_H
#define DRAW_EYE_EXACT_TRACE_H
#include "draw/eye/quick/quick.h"

/* A view as its rays need it. */
struct scene_look {
	double origin[3];            // of all rays: the camera in the eye's frame
	float cam_from_eye[3][3];
	float slip[2][3];            // as in the view
	const struct scene_level *level;
	const struct scene_lighting *light;
	const struct scene_beams *beams;
	const struct quick_look *quick;  // null: the march goes along the rays
	float soft;                  // half a pixel on the iris, mm
	bool textured;
};

/* Colour of n <= BATCH rays of unit direction; A = 1 where the eye is hit. Adds to *iris those that saw the iris. */
void scene_trace(float rgba[][4], int n, const float *dx, const float *dy, const float *dz, const struct scene *s,
                 const struct scene_look *look, long *iris);

#endif
