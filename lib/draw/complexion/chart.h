/* complexion_chart: a face as it lies on a square: Lambert's equal-area picture of the directions from a point behind the eyes, drawn
 * twice as large in its middle. A head has one seam there, a point at its back, and what mirrors the head mirrors the square.
 * Frame  any, mm.  Square  0..1 both ways, u to the person's left, v down; the middle is the direction out of the face.
 */
#ifndef DRAW_COMPLEXION_CHART_H
#define DRAW_COMPLEXION_CHART_H
#include <stdbool.h>
#include <stdint.h>

struct complexion_chart {
	double center[3];            // mm
	double head_from_frame[3][3];// rotation: x to the person's left, y up, z out of the face
	double half;                 // of the whole square's half that is drawn: 1 all of it
};

/* The chart of a head whose eyeballs' centres (left, right; mm) are these. */
struct complexion_chart complexion_chart_of(const double eye[2][3], const double head_from_frame[3][3], double half);

/* Where a point lies; outside 0..1 beyond what is drawn. */
void complexion_chart_at(float uv[2], const struct complexion_chart *chart, const float x[3]);

/* What a texel shows: a face of the mesh (-1: none) and the weights of its second and third corner. */
struct complexion_spot {
	int32_t face;
	float w[2];
};

/* The outermost face that looks outwards at the middle of every texel: [side][side]; free(). uv[n_faces][3][2]: where the corners
 * lie; show: [n_faces] or null; out: [n_faces][3] how far out corners are. */
struct complexion_spot *complexion_chart_raster(int side, int n_faces, const float (*uv)[3][2], const float (*out)[3], const bool *show);

/* The mean of what the corners v of its face have, by its weights. */
static inline void complexion_spot_mean(float out[3], const float (*of)[3], const int32_t v[3], const struct complexion_spot *s)
{
	for (int k = 0; k < 3; k++)
		out[k] = (1 - s->w[0] - s->w[1]) * of[v[0]][k] + s->w[0] * of[v[1]][k] + s->w[1] * of[v[2]][k];
}

#endif
