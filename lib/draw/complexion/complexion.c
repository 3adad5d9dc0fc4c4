#include "draw/complexion/complexion.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/complexion/impl.h"
#include "draw/smooth.h"
#include "math/stats.h"
#include "math/vec.h"

static const double half = 0.7;                // of the chart's half: 65 degrees to all sides
static const double lids_radii = 1.6;          // skin nearer to an eye than so many radii tells nothing of the light: lids move
static const double between_lids = 0.5, off_lids = 0.2;  // of the light on a face that reaches the white between the lids: straight, and off skin
static const double seen_least = 0.2;          // of the face near the eyes
static const double albedo_low = 0.03, albedo_high = 0.75;  // luminance of people's skins, with room

static double luminance(const double rgb[3])
{
	return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

struct complexion *complexion_new(const struct mesh *mesh, const double eye[2][3], double radius, const struct complexion_conf *conf)
{
	static const double same[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
	struct complexion *c = mem_new(1, sizeof *c);
	double d[3];
	*c = (struct complexion){ .mesh = mesh, .conf = *conf, .radius = radius, .side = (int)lrint(half * conf->side) };
	memcpy(c->eye, eye, sizeof c->eye);
	memcpy(c->hair.eye, eye, sizeof c->hair.eye);
	c->hair.radius = radius;
	c->chart = complexion_chart_of(eye, same, half);
	for (int k = 0; k < 3; k++)
		d[k] = 0.5 * (eye[0][k] + eye[1][k]) - c->chart.center[k];
	c->texel_mm = 2 * half * (vec_norm(d) + radius) / c->side;
	float (*at)[2] = mem_array((size_t)mesh->n_vertices + 1, sizeof *at), (*uv)[3][2] = mem_array((size_t)mesh->n_faces + 1, sizeof *uv);
	float *far = mem_array((size_t)mesh->n_vertices + 1, sizeof *far), (*out)[3] = mem_array((size_t)mesh->n_faces + 1, sizeof *out);
	for (int i = 0; i < mesh->n_vertices; i++) {
		complexion_chart_at(at[i], &c->chart, mesh->vertices[i]);
		for (int k = 0; k < 3; k++)
			d[k] = (double)mesh->vertices[i][k] - c->chart.center[k];
		far[i] = (float)vec_norm(d);
	}
	for (int f = 0; f < mesh->n_faces; f++)
		for (int k = 0; k < 3; k++) {
			memcpy(uv[f][k], at[mesh->faces[f][k]], sizeof uv[f][k]);
			out[f][k] = far[mesh->faces[f][k]];
		}
	c->spot = complexion_chart_raster(c->side, mesh->n_faces, (const float(*)[3][2])uv, (const float(*)[3])out, 0);
	free(at);
	free(uv);
	free(far);
	free(out);
	return c;
}

void complexion_free(struct complexion *c)
{
	if (!c)
		return;
	for (int i = 0; i < c->n_views; i++)
		free(c->view[i]);
	free(c->spot);
	free(c->ln);
	free(c->real);
	free(c);
}

/* Texels of skin that does not move with the lids. */
static bool *steady(const struct complexion *c, const float *weight)
{
	const long n = (long)c->side * c->side;
	bool *keep = mem_new((size_t)n + 1, sizeof *keep);
	for (long i = 0; i < n; i++) {
		float x[3];
		keep[i] = weight[i] > 0 && complexion_place(x, c, i);
		for (int s = 0; s < 2 && keep[i]; s++)
			keep[i] = hypot((double)x[0] - c->eye[s][0], (double)x[1] - c->eye[s][1]) > lids_radii * c->radius;
	}
	return keep;
}

/* Factors from the median skin as filmed, rgb, to albedo: by the white of the eyes, which lies between lids of that skin. False: they do not
 * give a person's skin. */
static bool by_white(double by[3], const struct complexion *c, const double rgb[3])
{
	double albedo[3];
	for (int k = 0; k < 3; k++) {
		const double ratio = c->white[k] > 0 ? c->conf.sclera_rgb[k] * rgb[k] / c->white[k] : 0;
		albedo[k] = between_lids * ratio / fmax(1 - off_lids * ratio, 0.1);
		by[k] = albedo[k] / rgb[k];
	}
	const double grey = luminance(albedo);
	return grey > albedo_low && grey < albedo_high && albedo[0] >= albedo[1] && albedo[1] >= 0.8 * albedo[2];
}

/* Scales ln to albedo, and takes the colour of the light off. Without white eyes the skin is as bright as the configured one. rgb: out, the
 * median albedo; hair: a colour that is scaled, too. */
static bool scale(double rgb[3], double hair[3], bool *white, float (*ln)[3], const float *weight, const struct complexion *c)
{
	const long n = (long)c->side * c->side;
	double by[3], *x = mem_array((size_t)(n / 8) + 2, sizeof *x);
	for (int k = 0; k < 3; k++) {
		int many = 0;
		for (long i = 0; i < n; i += 8)
			if (weight[i] > 0)
				x[many++] = (double)ln[i][k];
		rgb[k] = many ? exp(stats_median(many, x)) : 0;
	}
	free(x);
	*white = by_white(by, c, rgb);
	for (int k = 0; k < 3 && !*white; k++)
		by[k] = luminance(c->conf.skin_rgb) / luminance(rgb);
	for (int k = 0; k < 3; k++) {
		if (!(by[k] > 0) || !isfinite(by[k]))
			return false;
		for (long i = 0; i < n; i++)
			ln[i][k] += weight[i] > 0 ? (float)log(by[k]) : 0;
	}
	for (int k = 0; k < 3; k++) {
		rgb[k] *= by[k];
		hair[k] *= by[k];
	}
	return true;
}

bool complexion_make(struct complexion *c, struct complexion_report *r, struct err *err)
{
	const long n = (long)c->side * c->side;
	float *weight = mem_array((size_t)n + 1, sizeof *weight);
	double shade[3];
	*r = (struct complexion_report){ 0 };
	free(c->ln);
	free(c->real);
	c->ln = mem_array((size_t)n + 1, sizeof *c->ln);
	c->real = mem_array((size_t)n + 1, sizeof *c->real);
	complexion_gather(c->ln, weight, c);
	bool *keep = steady(c, weight), ok = complexion_unlight(c->ln, weight, keep, shade, r->light, c);
	if (!ok)
		err_set(err, "too little of the face is seen, or in light that cannot be taken off");
	float *before = mem_array((size_t)n + 1, sizeof *before);
	uint8_t *brow = mem_new((size_t)n + 1, 1);
	memcpy(before, weight, (size_t)n * sizeof *before);
	ok = ok && complexion_shave(weight, brow, (const float(*)[3])c->ln, c, err)
	     && complexion_brows(&c->hair, (const float(*)[3])c->ln, before, weight, brow, c, err);
	complexion_lashes_mean(c->hair.lid, c);
	if (ok && !scale(r->rgb, c->hair.rgb, &r->white, c->ln, weight, c))
		ok = err_set(err, "too dark");
	ok = ok && complexion_grain_measure(&c->grain, (const float(*)[3])c->ln, weight, c, err)
	     && complexion_fill(c->ln, c->real, weight, &r->seen, &r->mirrored, c, err);
	r->grain = c->grain.all;
	if (ok && r->seen < seen_least)
		ok = err_set(err, "%.0f %% of the face near the eyes is seen well, must be >= %.0f %%", 100 * r->seen, 100 * seen_least);
	free(keep);
	free(before);
	free(brow);
	free(weight);
	return ok;
}

const struct hair_film *complexion_hair(const struct complexion *c)
{
	return &c->hair;
}

/* ln of albedo and the share seen, bilinear; beyond the chart the mean. */
static float sample(float ln[3], const struct complexion *c, const float uv[2])
{
	const float x = uv[0] * (float)c->side - 0.5f, y = uv[1] * (float)c->side - 0.5f;
	float real = 0;
	if (!(x >= 0 && y >= 0 && x < (float)c->side - 1 && y < (float)c->side - 1)) {
		memcpy(ln, c->mean, sizeof c->mean);
		return 0;
	}
	const int x0 = (int)x, y0 = (int)y;
	const float fx = x - (float)x0, fy = y - (float)y0, rim = fminf(fminf(x, y), (float)c->side - 1 - fmaxf(x, y)) / (0.08f * (float)c->side);
	ln[0] = ln[1] = ln[2] = 0;
	for (int j = 0; j < 4; j++) {
		const long i = (long)(y0 + j / 2) * c->side + x0 + j % 2;
		const float w = (j % 2 ? fx : 1 - fx) * (j / 2 ? fy : 1 - fy);
		real += w * c->real[i];
		for (int k = 0; k < 3; k++)
			ln[k] += w * c->ln[i][k];
	}
	const float own = smooth(0, 1, rim);
	for (int k = 0; k < 3; k++)
		ln[k] = c->mean[k] + own * (ln[k] - c->mean[k]);
	return real * own;
}

float complexion_at(float rgb[3], const struct complexion *c, const float x[3])
{
	float uv[2], ln[3];
	complexion_chart_at(uv, &c->chart, x);
	const float real = sample(ln, c, uv);
	for (int k = 0; k < 3; k++)
		rgb[k] = expf(fminf(ln[k], 0));
	return real;
}
