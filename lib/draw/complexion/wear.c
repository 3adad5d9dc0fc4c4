/* A character that wears the skin of a person. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_blur.h"
#include "draw/complexion/impl.h"
#include "image/picture.h"
#include "math/vec.h"

static const double bump_mm = 0.7;         // what is finer stands out of the skin, or lies in it
static const double own_shade = 0.3;       // of its darkness that is its own shadow, which the bumps throw anew
static const double steepest = 0.6;        // slope
static const float wraps = 0.25f;          // of the chart: a face as large goes round the back of the head
static const double margin_rgb[3] = { 0.98, 0.72, 0.70 };  // mucous edge against skin
enum { QUALITY = 93 };

struct maker {
	const struct complexion *c;
	const struct complexion_wearer *w;
	int side;
	struct complexion_chart chart;
	float (*uv)[3][2];             // [n_faces]
	struct complexion_spot *spot;
	float (*rgb)[3], *fine, (*at)[3];  // [side][side] albedo; ln of its fine grain; place at rest, NAN: nothing
};

/* Wedges: a vertex each, and further ones for faces that would go round the back of the head, which show one place. */
static void wedges(struct look *l, struct maker *m)
{
	const struct complexion_wearer *w = m->w;
	float (*at)[2] = mem_array((size_t)w->n + 1, sizeof *at);
	int extra = 0;
	l->n_points = w->n;
	l->n_faces = w->n_faces;
	l->corner = mem_new((size_t)w->n_faces + 1, sizeof *l->corner);
	for (int i = 0; i < w->n; i++)
		complexion_chart_at(at[i], &m->chart, w->rest[i]);
	for (int pass = 0; pass < 2; pass++) {
		if (pass) {
			l->n_wedges = w->n + 3 * extra;
			l->point = mem_new((size_t)l->n_wedges + 1, sizeof *l->point);
			l->uv = mem_new((size_t)l->n_wedges + 1, sizeof *l->uv);
			l->normal = mem_new((size_t)l->n_wedges + 1, sizeof *l->normal);
			l->rgba = mem_new((size_t)l->n_wedges + 1, sizeof *l->rgba);
			for (int i = 0; i < w->n; i++) {
				l->point[i] = i;
				memcpy(l->uv[i], at[i], sizeof *l->uv);
			}
			extra = 0;
		}
		for (int f = 0; f < w->n_faces; f++) {
			const int32_t *v = w->faces[f];
			float low[2] = { 1, 1 }, high[2] = { 0, 0 };
			for (int k = 0; k < 6; k++) {
				low[k % 2] = fminf(low[k % 2], at[v[k / 2]][k % 2]);
				high[k % 2] = fmaxf(high[k % 2], at[v[k / 2]][k % 2]);
			}
			const bool round = high[0] - low[0] > wraps || high[1] - low[1] > wraps;
			for (int k = 0; k < 3 && pass; k++) {
				const int i = round ? w->n + 3 * extra + k : v[k];
				l->corner[f][k] = i;
				if (round) {  // a texel's triangle at the first corner
					l->point[i] = v[k];
					for (int j = 0; j < 2; j++)
						l->uv[i][j] = at[v[0]][j] + (k == j + 1 ? 1.0f / (float)m->side : 0);
				}
			}
			extra += round;
		}
	}
	for (int i = 0; i < l->n_wedges; i++) {
		memcpy(l->normal[i], w->normal[l->point[i]], sizeof *l->normal);
		for (int k = 0; k < 4; k++)
			l->rgba[i][k] = 1;
	}
	free(at);
}

/* What every texel of the character shows. */
static void lay(struct maker *m, const struct look *l)
{
	const struct complexion_wearer *w = m->w;
	float (*out)[3] = mem_array((size_t)w->n_faces + 1, sizeof *out);
	m->uv = mem_array((size_t)w->n_faces + 1, sizeof *m->uv);
	for (int f = 0; f < w->n_faces; f++)
		for (int k = 0; k < 3; k++) {
			const float *x = w->rest[w->faces[f][k]];
			const double d[3] = { (double)x[0] - m->chart.center[0], (double)x[1] - m->chart.center[1], (double)x[2] - m->chart.center[2] };
			memcpy(m->uv[f][k], l->uv[l->corner[f][k]], sizeof m->uv[f][k]);
			out[f][k] = (float)vec_norm(d);
		}
	m->spot = complexion_chart_raster(m->side, w->n_faces, (const float(*)[3][2])m->uv, (const float(*)[3])out, w->skin);
	free(out);
}

/* Width of a texel on the character, mm; from its neighbour. */
static double texel_of(const struct maker *m, long i)
{
	const long o = i % m->side + 1 < m->side ? i + 1 : i - 1;
	const double d[3] = { (double)(m->at[o][0] - m->at[i][0]), (double)(m->at[o][1] - m->at[i][1]), (double)(m->at[o][2] - m->at[i][2]) };
	const double mm = vec_norm(d);
	return mm < 20 ? fmax(mm, 1e-3) : 20;  // NAN: nothing there
}

static void paint(struct maker *m, long i)
{
	const struct complexion_spot *s = &m->spot[i];
	if (s->face < 0)
		return;
	const struct complexion *c = m->c;
	const int32_t *v = m->w->faces[s->face];
	float on[3], rgb[3];
	complexion_spot_mean(on, m->w->registered, v, s);
	const float real = complexion_at(rgb, c, on);
	const float rim = (1 - s->w[0] - s->w[1]) * m->w->margin[v[0]] + s->w[0] * m->w->margin[v[1]] + s->w[1] * m->w->margin[v[2]];
	const double grain = real < 1 ? (1 - (double)real) * complexion_grain_at(&c->grain, m->at[i], texel_of(m, i)) : 0;
	for (int k = 0; k < 3; k++)
		m->rgb[i][k] = (float)fmin((double)rgb[k] * exp(c->grain.slope[k] * grain) * (1 + (double)((1 - real) * rim) * (margin_rgb[k] - 1)), 1);
}

/* Takes on what is beside it where nothing is: pictures of textures look a texel beyond the edge, and far off their halves do. */
static bool surround(struct maker *m, struct err *err)
{
	const size_t n = (size_t)m->side * (size_t)m->side;
	float *all = mem_array(4 * n + 1, sizeof *all), mean[3];
	bool ok = true;
	for (int k = 0; k < 3; k++)
		mean[k] = expf(m->c->mean[k]);
	for (size_t i = 0; i < n; i++)
		for (int k = 0; k < 4; k++)
			all[4 * i + (size_t)k] = m->spot[i].face < 0 ? 0 : k < 3 ? m->rgb[i][k] : 1;
	ok = cv_blur(all, all, m->side, m->side, 4, 4, err);
	for (size_t i = 0; i < n && ok; i++)
		for (int k = 0; k < 3 && m->spot[i].face < 0; k++)
			m->rgb[i][k] = all[4 * i + 3] > 0.02f ? all[4 * i + (size_t)k] / all[4 * i + 3] : mean[k];
	free(all);
	return ok;
}

/* Fine grain of what is painted: ln of its luminance against that around. */
static bool fine_of(struct maker *m, struct err *err)
{
	const long n = (long)m->side * m->side;
	float *wide = mem_array((size_t)n + 1, sizeof *wide);
	const double texel = m->c->texel_mm / m->c->chart.half * m->c->side / m->side;
	for (long i = 0; i < n; i++)
		m->fine[i] = logf(0.2126f * m->rgb[i][0] + 0.7152f * m->rgb[i][1] + 0.0722f * m->rgb[i][2] + 1e-4f);
	const bool ok = cv_blur(wide, m->fine, m->side, m->side, 1, fmax(bump_mm / texel, 1), err);
	for (long i = 0; i < n && ok; i++)
		m->fine[i] -= wide[i];
	free(wide);
	return ok;
}

/* Slopes of a height that goes with the fine grain, along u and along smaller v: bright stands out. */
static void slope(double out[2], const struct maker *m, long i)
{
	const long x = i % m->side, y = i / m->side;
	out[0] = out[1] = 0;
	if (x < 1 || y < 1 || x + 1 >= m->side || y + 1 >= m->side || m->spot[i].face < 0)
		return;
	const long step[2] = { 1, -m->side };
	for (int a = 0; a < 2; a++) {
		const float *p = m->at[i + step[a]], *q = m->at[i - step[a]];
		const double d[3] = { (double)(p[0] - q[0]), (double)(p[1] - q[1]), (double)(p[2] - q[2]) }, mm = vec_norm(d);
		if (mm > 1e-3 && mm < 4)  // of one surface
			out[a] = (double)(m->fine[i + step[a]] - m->fine[i - step[a]]) / mm;
	}
}

static uint8_t *normals(const struct maker *m)
{
	const long n = (long)m->side * m->side;
	uint8_t *px = mem_array(3 * (size_t)n + 1, 1);
	double all = 0, many = 1e-9;
	for (long i = 0; i < n; i += 3) {
		double s[2], dx = i % m->side - 0.5 * m->side, dy = (double)(i / m->side) - 0.5 * m->side;
		if (dx * dx + dy * dy > 0.09 * m->side * m->side)
			continue;
		slope(s, m, i);
		all += s[0] * s[0] + s[1] * s[1];
		many += m->spot[i].face >= 0;
	}
	const double k = m->c->conf.bumps / fmax(sqrt(all / (2 * many)), 1e-6);
#pragma omp parallel for schedule(static)
	for (long i = 0; i < n; i++) {
		double s[2];
		slope(s, m, i);
		const double t[2] = { k * s[0], k * s[1] }, less = 1 / (1 + hypot(t[0], t[1]) / steepest), up = 1 / sqrt(1 + less * less * (t[0] * t[0] + t[1] * t[1]));
		const double normal[3] = { -less * t[0] * up, -less * t[1] * up, up };
		for (int c = 0; c < 3; c++)
			px[3 * i + c] = (uint8_t)lrint(fmin(fmax(127.5 + 127.5 * normal[c], 0), 255));
	}
	return px;
}

static uint8_t *colours(const struct maker *m)
{
	const long n = (long)m->side * m->side;
	uint8_t *px = mem_array(3 * (size_t)n + 1, 1);
#pragma omp parallel for schedule(static)
	for (long i = 0; i < n; i++)
		for (int k = 0; k < 3; k++)
			px[3 * i + k] = (uint8_t)lrintf(255 * srgb_from_linear(fminf(m->rgb[i][k] * expf(-(float)own_shade * m->fine[i]), 1)));
	return px;
}

static bool put(struct look *l, int at, const char *name, uint8_t *px, int side, struct err *err)
{
	uint8_t *jpeg = 0;
	size_t size = 0;
	const bool ok = picture_jpeg_encode(&jpeg, &size, px, side, side, 3, QUALITY, err);
	if (ok) {
		uint8_t *bytes = mem_grow((uint8_t *)l->bytes, (size_t)l->n_bytes + size, 1);
		memcpy(bytes + l->n_bytes, jpeg, size);
		l->bytes = bytes;
		l->texture[at] = (struct look_texture){ .name = mem_str(name), .width = side, .height = side, .size = (long)size };
		l->n_bytes += (long)size;
		l->n_textures = at + 1;
		long from = 0;
		for (int i = 0; i <= at; from += l->texture[i++].size)
			l->texture[i].bytes = l->bytes + from;
	}
	free(jpeg);
	free(px);
	return ok;
}

static void material(struct look *l)
{
	l->n_materials = 1;
	l->material = mem_new(1, sizeof *l->material);
	*l->material = (struct look_material){ .name = mem_str("skin"), .rgba = { 1, 1, 1, 1 }, .rough = 0.5, .normal_scale = 1, .map = { 0, 1, -1, -1, -1 } };
	l->texture = mem_new(2, sizeof *l->texture);
	l->n_parts = 1;
	l->part = mem_new(1, sizeof *l->part);
	l->part[0] = mem_str("skin");
	l->face_part = mem_new((size_t)l->n_faces + 1, sizeof *l->face_part);
	l->face_material = mem_new((size_t)l->n_faces + 1, sizeof *l->face_material);
	l->shape_start = mem_new(1, sizeof *l->shape_start);
	l->has_uv = true;
}

bool complexion_wear(struct look *l, const struct complexion *c, const struct complexion_wearer *w, struct err *err)
{
	struct maker m = { .c = c, .w = w, .side = c->conf.side, .chart = complexion_chart_of(w->eye, w->head_from_rest, 1) };
	const size_t n = (size_t)m.side * (size_t)m.side;
	*l = (struct look){ 0 };
	wedges(l, &m);
	lay(&m, l);
	material(l);
	m.rgb = mem_new(n + 1, sizeof *m.rgb);
	m.fine = mem_array(n + 1, sizeof *m.fine);
	m.at = mem_array(n + 1, sizeof *m.at);
	for (size_t i = 0; i < n; i++)
		if (m.spot[i].face < 0)
			m.at[i][0] = m.at[i][1] = m.at[i][2] = NAN;
		else
			complexion_spot_mean(m.at[i], w->rest, w->faces[m.spot[i].face], &m.spot[i]);
#pragma omp parallel for schedule(dynamic, 4096)
	for (size_t i = 0; i < n; i++)
		paint(&m, (long)i);
	const bool ok = surround(&m, err) && fine_of(&m, err) && put(l, 0, "skin_colour", colours(&m), m.side, err)
	                && put(l, 1, "skin_normal", normals(&m), m.side, err);
	free(m.uv);
	free(m.spot);
	free(m.rgb);
	free(m.fine);
	free(m.at);
	if (!ok)
		look_free(l);
	return ok;
}
