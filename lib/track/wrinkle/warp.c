/* Warps frames to the chart: the motion between the tracked points is interpolated by moving least squares. */
#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/chol.h"
#include "track/wrinkle/impl.h"

enum { STEP = 16 };  // px between places where the motion is fitted

struct motion {
	int nx, ny;
	float (*shift)[3];  // x, y, weight
};

/* Affine fit, at p, to the motion of the points round it; Gaussian weights, e^-1/2 at `reach`. */
static void motion_at(float out[3], const struct wrinkle_ground *g, const struct wrinkle_frame *f, const double p[2], double reach)
{
	double H[9] = { 0 }, b[2][3] = { { 0 } }, total = 0;
	for (int i = 0; i < g->n; i++) {
		double u[3] = { 1, (g->at[i][0] - p[0]) / reach, (g->at[i][1] - p[1]) / reach }, r2 = u[1] * u[1] + u[2] * u[2];
		if (r2 > 9 || !(f->confidence[i] > 0))
			continue;
		double w = f->confidence[i] * exp(-0.5 * r2);
		total += w;
		for (int j = 0; j < 3; j++) {
			for (int k = 0; k <= j; k++)
				H[3 * j + k] += w * u[j] * u[k];
			for (int k = 0; k < 2; k++)
				b[k][j] += w * u[j] * ((double)f->at[i][k] - g->at[i][k]);
		}
	}
	out[0] = out[1] = 0;
	out[2] = (float)total;
	for (int k = 0; k < 2 && total > 0; k++) {
		double L[9];
		for (int j = 0; j < 9; j++)
			L[j] = H[j] + (j % 4 ? 0 : 1e-2);
		if (chol_solve(3, 3, L, b[k]))
			out[k] = (float)b[k][0];
	}
}

static struct motion motion_of(const struct wrinkle_ground *g, const struct wrinkle_frame *f)
{
	struct motion m = { g->width / STEP + 2, g->height / STEP + 2, 0 };
	double reach = 1.2 * sqrt((double)g->width * g->height / fmax(g->n, 1));
	m.shift = mem_array((size_t)m.nx * (size_t)m.ny, sizeof *m.shift);
#pragma omp parallel for schedule(dynamic)
	for (int j = 0; j < m.ny; j++)
		for (int i = 0; i < m.nx; i++)
			motion_at(m.shift[j * m.nx + i], g, f, (double[]){ g->x0 + i * STEP, g->y0 + j * STEP }, reach);
	return m;
}

static void shift_at(float out[3], const struct motion *m, double x, double y)
{
	int i = (int)(x / STEP), j = (int)(y / STEP);
	float u = (float)(x / STEP - i), v = (float)(y / STEP - j);
	const float(*s)[3] = (const float(*)[3])m->shift + j * m->nx + i;
	for (int k = 0; k < 3; k++)
		out[k] = (1 - v) * ((1 - u) * s[0][k] + u * s[1][k]) + v * ((1 - u) * s[m->nx][k] + u * s[m->nx + 1][k]);
}

/* Keys' cubic convolution (a = -1/2): shifting by half a px blurs hardly more than not shifting. */
static void cubic(float w[4], float t)
{
	w[0] = ((-0.5f * t + 1) * t - 0.5f) * t;
	w[1] = (1.5f * t - 2.5f) * t * t + 1;
	w[2] = ((-1.5f * t + 2) * t + 0.5f) * t;
	w[3] = (0.5f * t - 0.5f) * t * t;
}

/* x, y: at least 1.5 px within the frame's part. */
static float light_at(const struct wrinkle_ground *g, const uint8_t *grey, const float linear[256], double x, double y)
{
	int i = (int)floor(x - 0.5), j = (int)floor(y - 0.5);
	float u[4], v[4], sum = 0;
	cubic(u, (float)(x - 0.5 - i));
	cubic(v, (float)(y - 0.5 - j));
	for (int b = 0; b < 4; b++) {
		const uint8_t *row = grey + (long)(j - 1 + b) * g->width + i - 1;
		for (int a = 0; a < 4; a++)
			sum += u[a] * v[b] * linear[row[a]];
	}
	return sum;
}

void wrinkle_unwrap(float *log_light, uint8_t *sure, const struct wrinkle_ground *g, const struct wrinkle_frame *f)
{
	struct motion m = motion_of(g, f);
	float linear[256];
	for (int i = 0; i < 256; i++)
		linear[i] = linear_from_srgb((float)i / 255);
#pragma omp parallel for schedule(dynamic, 16)
	for (int y = 0; y < g->height; y++)
		for (int x = 0; x < g->width; x++) {
			float s[3];
			shift_at(s, &m, x + 0.5, y + 0.5);
			double u = x + 0.5 + s[0], v = y + 0.5 + s[1];
			long at = (long)y * g->width + x;
			sure[at] = s[2] > 0.05f && u > 2 && v > 2 && u < g->width - 2 && v < g->height - 2 ? 255 : 0;
			// Offset of half an 8-bit step: the logarithm of black is finite.
			log_light[at] = sure[at] ? logf(fmaxf(light_at(g, f->grey, linear, u, v), 0) + 1e-3f) : 0;
		}
	free(m.shift);
}
