#include "tissue/light/iris_light.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/vec.h"
#include "optics/lightpath/lightpath.h"

enum { LIGHTS = 128 };

/* A row of places on the iris plane, as the solver takes them. */
struct row {
	int n;
	float *x, *y, *z, *wx, *wy, *wz, *kx, *ky, *kz, *gain;
	unsigned char *status;
};

static struct row row_new(int n)
{
	struct row r = { .n = n };
	float **all[] = { &r.x, &r.y, &r.z, &r.wx, &r.wy, &r.wz, &r.kx, &r.ky, &r.kz, &r.gain };
	for (int i = 0; i < COUNT(all); i++)
		*all[i] = mem_array((size_t)n, sizeof(float));
	r.status = mem_array((size_t)n, 1);
	return r;
}

static void row_free(struct row *r)
{
	float *all[] = { r->x, r->y, r->z, r->wx, r->wy, r->wz, r->kx, r->ky, r->kz, r->gain };
	for (int i = 0; i < COUNT(all); i++)
		free(all[i]);
	free(r->status);
}

/* Fresnel's transmittance, unpolarised, and the refracted ray's slope are the same both ways: by the angle outside. */
static double transmittance(double cos_out, double n)
{
	double t = sqrt(n * n - 1 + cos_out * cos_out), s = (cos_out - t) / (cos_out + t), p = (n * n * cos_out - t) / (n * n * cos_out + t);
	return 1 - 0.5 * (s * s + p * p);
}

static double cos_at(const struct cornea *cornea, const double K[3], const double w[3])
{
	double N[3];
	cornea_normal(N, cornea, K);
	return vec_dot(N, w);
}

/* Adds one light to a row of the map; slant: its row, or null. */
static void add_light(float *out, float *slant, struct row *r, const struct cornea *cornea, const float w[3], const float rgb[3])
{
	for (int i = 0; i < r->n; i++) {
		r->wx[i] = w[0];
		r->wy[i] = w[1];
		r->wz[i] = w[2];
	}
	lightpath_batch(r->n, r->x, r->y, r->z, r->wx, r->wy, r->wz, r->kx, r->ky, r->kz, r->status, cornea, 4);
	lightpath_gain_batch(r->n, r->x, r->y, r->z, r->wx, r->wy, r->wz, r->kx, r->ky, r->kz, r->gain, cornea);
	for (int i = 0; i < r->n; i++) {
		if (r->status[i] != LIGHTPATH_OK || !(r->gain[i] > 0))
			continue;
		float d[3] = { r->kx[i] - r->x[i], r->ky[i] - r->y[i], r->kz[i] - r->z[i] };
		float down = -d[2] / sqrtf(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), all = 0;
		for (int c = 0; c < 3; c++) {
			out[4 * i + c] += r->gain[i] * rgb[c];
			all += r->gain[i] * rgb[c];
		}
		out[4 * i + 3] += all * down;
		if (!slant)
			continue;
		float along = -1 / fminf(d[2], -1e-6f), s[2] = { d[0] * along, d[1] * along }, length = hypotf(s[0], s[1]);
		float shorter = length > IRIS_SLANT_MOST ? IRIS_SLANT_MOST / length : 1, x = shorter * s[0], y = shorter * s[1];
		const float sums[IRIS_SLANT] = { 1, x, y, x * x, x * y, y * y };
		for (int k = 0; k < IRIS_SLANT; k++)
			slant[IRIS_SLANT * i + k] += all * sums[k];
	}
}

/* The way out: multiplies by T / n^2. C: the camera in the eye's frame. */
static void see(float *out, struct row *r, const struct cornea *cornea, const double C[3])
{
	lightpath_batch_point(r->n, r->x, r->y, r->z, C, r->kx, r->ky, r->kz, r->status, cornea, 4);
	for (int i = 0; i < r->n; i++) {
		double K[3] = { r->kx[i], r->ky[i], r->kz[i] }, w[3] = { C[0] - K[0], C[1] - K[1], C[2] - K[2] }, gain = 0;
		vec_unit(w, w);
		if (r->status[i] == LIGHTPATH_OK)
			gain = transmittance(cos_at(cornea, K, w), cornea->n) / (cornea->n * cornea->n);
		float sum = out[4 * i] + out[4 * i + 1] + out[4 * i + 2];
		out[4 * i + 3] = sum > 0 ? out[4 * i + 3] / sum : 0;
		for (int c = 0; c < 3; c++)
			out[4 * i + c] *= (float)gain;
	}
}

void iris_light_make(struct image *out, struct image *slant, int n, double extent, const struct iris_view *view)
{
	struct envmap_light light[LIGHTS];
	struct cornea cornea = eye_cornea(view->eye);
	int lights = envmap_lights_spread(light, LIGHTS, view->env);
	double C[3] = { 0 };
	for (int l = 0; l < lights; l++) {
		float w[3] = { 0 };
		for (int j = 0; j < 3; j++)
			for (int i = 0; i < 3; i++)
				w[j] += (float)view->cam_from_eye[i][j] * light[l].dir[i];
		for (int j = 0; j < 3; j++)
			light[l].dir[j] = w[j];
	}
	for (int j = 0; j < 3; j++)
		for (int i = 0; i < 3; i++)
			C[j] -= view->cam_from_eye[i][j] * view->cam_from_eye[i][3];
	*out = image_new(n, n, 4);
	if (slant)
		*slant = image_new(n, n, IRIS_SLANT);
#pragma omp parallel for schedule(dynamic)
	for (int y = 0; y < n; y++) {
		struct row r = row_new(n);
		for (int x = 0; x < n; x++) {
			r.x[x] = (float)((2 * (x + 0.5) / n - 1) * extent);
			r.y[x] = (float)((2 * (y + 0.5) / n - 1) * extent);
			r.z[x] = (float)view->eye->iris_depth;
		}
		for (int l = 0; l < lights; l++)
			if (light[l].dir[2] < 0.16f)  // from further behind nothing reaches the iris
				add_light(image_at(out, 0, y), slant ? image_at(slant, 0, y) : 0, &r, &cornea, light[l].dir, light[l].rgb);
		see(image_at(out, 0, y), &r, &cornea, C);
		row_free(&r);
	}
}

const char *const iris_lit_names[IRIS_LIT] = { "R", "G", "B", "cos", "sx", "sy", "xx", "xy", "yy" };

struct image iris_lit(const struct image *light, const struct image *slant)
{
	struct image out = image_new(light->width, light->height, IRIS_LIT);
	for (long i = 0; i < (long)light->width * light->height; i++) {
		const float *from = light->px + 4 * i, *s = slant->px + IRIS_SLANT * i;
		float *to = out.px + IRIS_LIT * i, all = s[0] > 1e-9f ? s[0] : 1, x = s[1] / all, y = s[2] / all;
		for (int c = 0; c < 4; c++)
			to[c] = from[c];
		to[4] = x;
		to[5] = y;
		to[6] = s[3] / all - x * x;
		to[7] = s[4] / all - x * y;
		to[8] = s[5] / all - y * y;
	}
	return out;
}
