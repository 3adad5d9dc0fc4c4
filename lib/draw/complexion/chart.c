#include "draw/complexion/chart.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"

static const double behind = 1.13;  // distances between the eyes that the point lies behind them: in the middle of a head

struct complexion_chart complexion_chart_of(const double eye[2][3], const double head_from_frame[3][3], double half)
{
	struct complexion_chart c = { .half = half };
	double d[3];
	vec_add(d, eye[0], -1, eye[1]);
	memcpy(c.head_from_frame, head_from_frame, sizeof c.head_from_frame);
	for (int k = 0; k < 3; k++)
		c.center[k] = 0.5 * (eye[0][k] + eye[1][k]) - behind * vec_norm(d) * head_from_frame[2][k];
	return c;
}

void complexion_chart_at(float uv[2], const struct complexion_chart *c, const float x[3])
{
	double d[3] = { x[0] - c->center[0], x[1] - c->center[1], x[2] - c->center[2] }, h[3];
	mat_vec(h, c->head_from_frame, d);
	const double across = hypot(h[0], h[1]), r = sin(0.5 * atan2(across, h[2])), k = across > 1e-12 ? 2 * r / (1 + r) / (across * c->half) : 0;
	uv[0] = (float)(0.5 + 0.5 * k * h[0]);
	uv[1] = (float)(0.5 - 0.5 * k * h[1]);
}

struct raster {
	int side;
	const float (*uv)[3][2], (*out)[3];
	struct complexion_spot *spot;
	float *far;
};

static void fill(struct raster *r, int f, int low, int high)
{
	const float (*t)[2] = (const float(*)[2])r->uv[f];
	float x[3], y[3];
	for (int k = 0; k < 3; k++) {
		x[k] = t[k][0] * (float)r->side;
		y[k] = t[k][1] * (float)r->side;
	}
	const float area = (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0]), k = 1 / area;
	if (!(area < -1e-9f))  // counter-clockwise from outside; v points down
		return;
	const int y0 = (int)fmaxf(ceilf(fminf(fminf(y[0], y[1]), y[2]) - 0.5f), (float)low);
	const int y1 = (int)fminf(floorf(fmaxf(fmaxf(y[0], y[1]), y[2]) - 0.5f), (float)high - 1);
	const int x0 = (int)fmaxf(ceilf(fminf(fminf(x[0], x[1]), x[2]) - 0.5f), 0);
	const int x1 = (int)fminf(floorf(fmaxf(fmaxf(x[0], x[1]), x[2]) - 0.5f), (float)r->side - 1);
	for (int j = y0; j <= y1; j++)
		for (int i = x0; i <= x1; i++) {
			const float px = (float)i + 0.5f - x[0], py = (float)j + 0.5f - y[0];
			const float b = (px * (y[2] - y[0]) - py * (x[2] - x[0])) * k, c = (py * (x[1] - x[0]) - px * (y[1] - y[0])) * k, a = 1 - b - c;
			if (a < -1e-5f || b < -1e-5f || c < -1e-5f)
				continue;
			const float far = a * r->out[f][0] + b * r->out[f][1] + c * r->out[f][2];
			const long at = (long)j * r->side + i;
			if (far > r->far[at]) {
				r->far[at] = far;
				r->spot[at] = (struct complexion_spot){ f, { b, c } };
			}
		}
}

struct complexion_spot *complexion_chart_raster(int side, int n_faces, const float (*uv)[3][2], const float (*out)[3], const bool *show)
{
	enum { BAND = 64 };
	const size_t n = (size_t)side * (size_t)side;
	struct raster r = { side, uv, out, mem_array(n + 1, sizeof *r.spot), mem_array(n + 1, sizeof *r.far) };
#pragma omp parallel for schedule(dynamic)
	for (int band = 0; band < (side + BAND - 1) / BAND; band++) {
		const int low = band * BAND, high = low + BAND < side ? low + BAND : side;
		for (long i = (long)low * side; i < (long)high * side; i++) {
			r.spot[i] = (struct complexion_spot){ -1, { 0, 0 } };
			r.far[i] = -INFINITY;
		}
		for (int f = 0; f < n_faces; f++)
			if (!show || show[f])
				fill(&r, f, low, high);
	}
	free(r.far);
	return r.spot;
}
