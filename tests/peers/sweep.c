#include "tests/peers/sweep_impl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_photo.h"
#include "image/picture.h"
#include "math/stats.h"
#include "math/vec.h"

enum { AGREE = 3 };

static void focus(double out[3], const struct views_truth *t)
{
	double A[3][3] = { 0 }, b[3] = { 0 }, c[3][3];
	for (int i = 0; i < t->n; i++)
		for (int r = 0; r < 3; r++)
			for (int k = 0; k < 3; k++) {
				double p = (r == k) - t->c[i].R[2][r] * t->c[i].R[2][k];
				A[r][k] += p;
				b[r] += p * t->c[i].center[k];
			}
	for (int i = 0; i < 3; i++)
		vec_cross(c[i], A[(i + 1) % 3], A[(i + 2) % 3]);
	for (int i = 0; i < 3; i++)
		out[i] = (c[0][i] * b[0] + c[1][i] * b[1] + c[2][i] * b[2]) / vec_dot(A[0], c[0]);
}

static bool load(struct shot *s, const struct views_camera *c, const char *images, int shrink, struct err *err)
{
	uint8_t *px, *small;
	int w, h;
	char *path = mem_printf("%s/%s.jpg", images, c->name);
	bool ok = picture_read(&px, &w, &h, path, 100, err);
	free(path);
	if (!ok)
		return false;
	*s = (struct shot){ .w = w / shrink, .h = h / shrink, .c = c };
	small = cv_resize8(px, w, h, 3, s->w, s->h);
	s->px = mem_array((size_t)s->w * (size_t)s->h, sizeof(float));
	s->depth = mem_new((size_t)s->w * (size_t)s->h, sizeof(float));
	for (long i = 0; i < (long)s->w * s->h; i++)
		s->px[i] = small[3 * i + 1];
	double fx = (double)s->w / w, fy = (double)s->h / h;
	memcpy(s->K, c->K, sizeof s->K);
	for (int k = 0; k < 3; k++) {
		s->K[0][k] *= fx;
		s->K[1][k] *= fy;
	}
	// Centres of pixels: half a pixel of the small picture is 0.5 / f of the large one.
	s->K[0][2] += 0.5 * fx - 0.5;
	s->K[1][2] += 0.5 * fy - 0.5;
	free(px);
	free(small);
	return true;
}

/* How many other pictures measured the same place. */
static int agreeing(const struct shot *shots, int n, int i, const double world[3])
{
	int agree = 0;
	for (int k = 0; k < n; k++) {
		double px[3];
		if (k == i || !shot_drop(px, &shots[k], world))
			continue;
		double z = (double)shots[k].depth[(long)(px[1] + 0.5) * shots[k].w + (long)(px[0] + 0.5)];
		agree += z > 0 && fabs(z - px[2]) < 0.004 * px[2];
	}
	return agree;
}

static void collect(struct sweep_points *out, const struct shot *shots, int n)
{
	long room = 0;
	for (int i = 0; i < n; i++)
		for (int y = 2; y < shots[i].h - 2; y += 2)
			for (int x = 2; x < shots[i].w - 2; x += 2) {
				const struct shot *s = &shots[i];
				const float *z = s->depth + (long)y * s->w + x;
				double p[5][3], u[3], v[3], normal[3], from[3];
				if (!(z[0] > 0 && z[-2] > 0 && z[2] > 0 && z[-2 * s->w] > 0 && z[2 * s->w] > 0))
					continue;
				shot_lift(p[0], s, x, y, (double)z[0]);
				vec_add(from, p[0], -1, out->center);
				if (vec_norm(from) > out->radius || agreeing(shots, n, i, p[0]) < AGREE)
					continue;
				shot_lift(p[1], s, x - 2, y, (double)z[-2]);
				shot_lift(p[2], s, x + 2, y, (double)z[2]);
				shot_lift(p[3], s, x, y - 2, (double)z[-2 * s->w]);
				shot_lift(p[4], s, x, y + 2, (double)z[2 * s->w]);
				vec_add(u, p[2], -1, p[1]);
				vec_add(v, p[4], -1, p[3]);
				vec_cross(normal, v, u);
				vec_unit(normal, normal);
				if (out->n == room) {
					room = room ? 2 * room : 1 << 16;
					out->xyz = mem_grow(out->xyz, (size_t)room, sizeof *out->xyz);
					out->normal = mem_grow(out->normal, (size_t)room, sizeof *out->normal);
				}
				for (int k = 0; k < 3; k++) {
					out->xyz[out->n][k] = (float)p[0][k];
					out->normal[out->n][k] = (float)normal[k];
				}
				out->n++;
			}
}

bool sweep(struct sweep_points *out, const struct views_truth *truth, const char *images, int shrink, int planes,
           struct err *err)
{
	struct shot *shots = mem_new((size_t)truth->n, sizeof *shots);
	double *far = mem_array((size_t)truth->n, sizeof *far);
	bool ok = true;
	*out = (struct sweep_points){ 0 };
	focus(out->center, truth);
	for (int i = 0; i < truth->n && ok; i++) {
		double d[3];
		ok = load(&shots[i], &truth->c[i], images, shrink, err);
		vec_add(d, truth->c[i].center, -1, out->center);
		far[i] = vec_norm(d);
	}
	// The head fills about a third of the way from its middle to the cameras.
	out->radius = ok ? 0.45 * stats_median(truth->n, far) : 0;
#pragma omp parallel for schedule(dynamic) if (ok)
	for (int i = 0; i < truth->n; i++) {
		double d[3], p[3];
		if (!ok)
			continue;
		vec_add(d, out->center, -1, truth->c[i].center);
		mat_vec(p, truth->c[i].R, d);
		shot_sweep(shots, truth->n, i, out->center, fmax(0.1 * out->radius, p[2] - out->radius), p[2] + out->radius, planes);
	}
	if (ok)
		collect(out, shots, truth->n);
	for (int i = 0; i < truth->n; i++) {
		free(shots[i].px);
		free(shots[i].depth);
	}
	free(shots);
	free(far);
	return ok;
}

void sweep_free(struct sweep_points *p)
{
	free(p->xyz);
	free(p->normal);
	*p = (struct sweep_points){ 0 };
}
