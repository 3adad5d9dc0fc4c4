#include "limbus/occlusion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/call.h"
#include "base/mem.h"
#include "image/photo/part.h"
#include "image/plane.h"
#include "net/net.h"

enum { PART = 224, PIXELS = OCCLUSION_SIDE * OCCLUSION_SIDE };  // px, sides of the part of the photograph that is looked at
static const float LEAST_CONTRAST = 0.05F;

struct occlusion_net {
	struct net *net;
};

bool occlusion_open(struct occlusion_net **out, const char *path, struct err *err)
{
	struct net *net;
	*out = 0;
	if (!net_open(&net, path, (const int[3]){ OCCLUSION_PLANES, OCCLUSION_SIDE, OCCLUSION_SIDE }, (const int[3]){ OCCLUSION_CLASSES, OCCLUSION_CELLS, OCCLUSION_CELLS }, err))
		return false;
	*out = mem_new(1, sizeof **out);
	(*out)->net = net;
	return true;
}

bool occlusion_open_shipped(struct occlusion_net **net, struct err *err)
{
	char *path = call_config_file("occlusion.onnx");
	const bool ok = occlusion_open(net, path, err);
	free(path);
	return ok;
}

void occlusion_close(struct occlusion_net *net)
{
	if (net)
		net_close(net->net);
	free(net);
}

void occlusion_place(double p[2], const struct ellipse *e, double u, double v)
{
	double d[2];
	ellipse_span(d, e, u, v);
	p[0] = e->cx + d[0];
	p[1] = e->cy + d[1];
}

void occlusion_sample(float out[OCCLUSION_SEEN][OCCLUSION_SIDE][OCCLUSION_SIDE], const struct photo *photo, const struct evidence *evidence, const struct ellipse *e)
{
	const double reach = M_SQRT2 * OCCLUSION_REACH * e->a, scale = 2 * reach / PART, x0 = e->cx - reach, y0 = e->cy - reach;
	float *part = photo_part(photo, x0, y0, scale, PART, PART);
#pragma omp parallel for
	for (int j = 0; j < OCCLUSION_SIDE; j++)
		for (int i = 0; i < OCCLUSION_SIDE; i++) {
			double p[2];
			occlusion_place(p, e, OCCLUSION_REACH * (2 * (i + 0.5) / OCCLUSION_SIDE - 1), OCCLUSION_REACH * (2 * (j + 0.5) / OCCLUSION_SIDE - 1));
			for (int c = 0; c < 3; c++)
				out[c][j][i] = plane_sample(part + c * PART * PART, PART, PART, (p[0] - x0) / scale, (p[1] - y0) / scale);
			float told[EVIDENCE_TOLD];
			evidence_told(told, evidence, p[0], p[1]);
			for (int k = 0; k < EVIDENCE_TOLD; k++)
				out[3 + k][j][i] = told[k];
		}
	free(part);
}

/* What the network takes: the photograph without its mean colour and its contrast, its darkest channel as it is (a light saturates all), chances about 0. */
static void even(float *in, float seen[OCCLUSION_SEEN][OCCLUSION_SIDE][OCCLUSION_SIDE])
{
	const float *rgb = &seen[0][0][0];
	double mean[3] = { 0 }, square = 0;
	for (int c = 0; c < 3; c++)
		for (int i = 0; i < PIXELS; i++)
			mean[c] += rgb[c * PIXELS + i] / PIXELS;
	for (int i = 0; i < PIXELS; i++) {
		double grey = 0;
		for (int c = 0; c < 3; c++)
			grey += (rgb[c * PIXELS + i] - mean[c]) / 3;
		square += grey * grey / (PIXELS - 1);
	}
	const float gain = 1 / ((float)sqrt(square) + LEAST_CONTRAST);
	for (int i = 0; i < PIXELS; i++) {
		for (int c = 0; c < 3; c++)
			in[c * PIXELS + i] = gain * (rgb[c * PIXELS + i] - (float)mean[c]);
		for (int c = 3; c < OCCLUSION_SEEN; c++)
			in[c * PIXELS + i] = 2 * rgb[c * PIXELS + i] - 0.5F;
		in[OCCLUSION_SEEN * PIXELS + i] = 2 * fminf(rgb[i], fminf(rgb[PIXELS + i], rgb[2 * PIXELS + i])) - 0.5F;
	}
}

/* Adds half of a run's chances, from their logits. */
static void add(struct occlusion *occlusion, const float *logit, bool mirrored)
{
	enum { N = OCCLUSION_CELLS * OCCLUSION_CELLS };
	for (int i = 0; i < N; i++) {
		float p[OCCLUSION_CLASSES], sum = 0, most = logit[i];
		for (int k = 1; k < OCCLUSION_CLASSES; k++)
			most = fmaxf(most, logit[k * N + i]);
		for (int k = 0; k < OCCLUSION_CLASSES; k++)
			sum += p[k] = expf(logit[k * N + i] - most);
		const int x = i % OCCLUSION_CELLS, y = i / OCCLUSION_CELLS;
		for (int k = 0; k < OCCLUSION_CLASSES; k++)
			occlusion->p[k][y][mirrored ? OCCLUSION_CELLS - 1 - x : x] += 0.5F * p[k] / sum;
	}
}

/* The inverse of S, in cells. */
static void frame_of(struct occlusion *out, const struct ellipse *e)
{
	double q[ELLIPSE_N];
	ellipse_to_q(q, e);
	const double a = q[2] + q[3], b = q[4], d = q[2] - q[3], to = OCCLUSION_CELLS / (2 * OCCLUSION_REACH * (a * d - b * b));
	out->origin[0] = q[0];
	out->origin[1] = q[1];
	out->cells[0][0] = to * d;
	out->cells[0][1] = out->cells[1][0] = -to * b;
	out->cells[1][1] = to * a;
}

bool occlusion_read(struct occlusion *out, struct occlusion_net *net, const struct photo *photo, const struct evidence *evidence, const struct ellipse *limbus, struct err *err)
{
	float (*seen)[OCCLUSION_SIDE][OCCLUSION_SIDE] = mem_array(OCCLUSION_SEEN, sizeof *seen), *in[2];
	struct net_picture run[2] = { 0 };
	memset(out, 0, sizeof *out);
	frame_of(out, limbus);
	occlusion_sample(seen, photo, evidence, limbus);
	for (int k = 0; k < 2; k++)
		in[k] = mem_array(OCCLUSION_PLANES * PIXELS, sizeof(float));
	even(in[0], seen);
	for (int i = 0; i < OCCLUSION_PLANES * PIXELS; i++)
		in[1][i] = in[0][i / OCCLUSION_SIDE * OCCLUSION_SIDE + OCCLUSION_SIDE - 1 - i % OCCLUSION_SIDE];
	for (int k = 0; k < 2; k++)
		run[k] = (struct net_picture){ .in = in[k], .height = OCCLUSION_SIDE, .width = OCCLUSION_SIDE };
	const bool ok = net_run(run, 2, net->net, OCCLUSION_PLANES, err);
	for (int k = 0; k < 2; k++) {
		if (ok)
			add(out, run[k].out, k);
		free(run[k].out);
		free(in[k]);
	}
	free(seen);
	return ok;
}

float occlusion_at(const struct occlusion *o, enum occlusion_class class, double x, double y)
{
	const double dx = x - o->origin[0], dy = y - o->origin[1], mid = 0.5 * OCCLUSION_CELLS;
	return plane_sample(&o->p[class][0][0], OCCLUSION_CELLS, OCCLUSION_CELLS, mid + o->cells[0][0] * dx + o->cells[0][1] * dy,
	                    mid + o->cells[1][0] * dx + o->cells[1][1] * dy);
}
