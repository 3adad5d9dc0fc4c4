#include "image/saliency.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum { LEVELS = 9, ANGLES = 4, GABOR = 9, MAP_LEVEL = 4, FIRST = 2, CENTRES = 3 };

struct level {
	int width, height;
	float *px;
};
struct pyramid {
	struct level level[LEVELS];
};

static struct level level_new(int width, int height)
{
	return (struct level){ width, height, mem_new((size_t)(width * height) + 1, sizeof(float)) };
}

static float at(const struct level *l, int x, int y)
{
	x = x < 0 ? 0 : x >= l->width ? l->width - 1 : x;
	y = y < 0 ? 0 : y >= l->height ? l->height - 1 : y;
	return l->px[y * l->width + x];
}

/* Half the size after the binomial filter 1 4 6 4 1. */
static struct level halved(const struct level *in)
{
	static const float k[5] = { 0.0625f, 0.25f, 0.375f, 0.25f, 0.0625f };
	struct level out = level_new((in->width + 1) / 2, (in->height + 1) / 2), half = level_new(out.width, in->height);
	for (int y = 0; y < in->height; y++)
		for (int x = 0; x < half.width; x++)
			for (int i = 0; i < 5; i++)
				half.px[y * half.width + x] += k[i] * at(in, 2 * x + i - 2, y);
	for (int y = 0; y < out.height; y++)
		for (int x = 0; x < out.width; x++)
			for (int i = 0; i < 5; i++)
				out.px[y * out.width + x] += k[i] * at(&half, x, 2 * y + i - 2);
	free(half.px);
	return out;
}

/* base: taken over. */
static struct pyramid pyramid_new(struct level base)
{
	struct pyramid p = { .level[0] = base };
	for (int l = 1; l < LEVELS; l++)
		p.level[l] = halved(&p.level[l - 1]);
	return p;
}

static void pyramid_free(struct pyramid *p)
{
	for (int l = 0; l < LEVELS; l++)
		free(p->level[l].px);
}

/* Value of a level at the place of pixel (x, y) of a map of that size; bilinear. */
static float resampled(const struct level *l, int x, int y, int width, int height)
{
	float u = ((float)x + 0.5f) * (float)l->width / (float)width - 0.5f;
	float v = ((float)y + 0.5f) * (float)l->height / (float)height - 0.5f;
	int i = (int)floorf(u), j = (int)floorf(v);
	float a = u - (float)i, b = v - (float)j;
	return (1 - b) * ((1 - a) * at(l, i, j) + a * at(l, i + 1, j)) + b * ((1 - a) * at(l, i, j + 1) + a * at(l, i + 1, j + 1));
}

/* The operator N (normalisation): scales the map to 0..1 and multiplies it by (1 - mean of the other local maxima) squared:
 * a single peak is promoted, many alike are suppressed. */
static void promote(struct level *m)
{
	float low = INFINITY, high = -INFINITY;
	int n = m->width * m->height, peaks = 0;
	for (int i = 0; i < n; i++) {
		low = fminf(low, m->px[i]);
		high = fmaxf(high, m->px[i]);
	}
	double sum = 0;
	for (int i = 0; i < n; i++)
		m->px[i] = high - low > 1e-6f ? (m->px[i] - low) / (high - low) : 0;
	for (int y = 0; y < m->height; y++)
		for (int x = 0; x < m->width; x++) {
			float v = at(m, x, y);
			bool peak = v > 0.05f && v < 1;
			for (int k = 0; k < 9 && peak; k++)
				peak = k == 4 || v >= at(m, x + k % 3 - 1, y + k / 3 - 1);
			sum += peak ? v : 0;
			peaks += peak;
		}
	double others = peaks ? sum / peaks : 0;
	for (int i = 0; i < n; i++)
		m->px[i] *= (float)((1 - others) * (1 - others));
}

/* |centre - surround| for c = 2, 3, 4 and s = c + 3, c + 4, each normalised and added to out. */
static void centre_surround(struct level *out, const struct pyramid *p)
{
	for (int c = FIRST; c < FIRST + CENTRES; c++)
		for (int d = 3; d <= 4; d++) {
			const struct level *centre = &p->level[c], *surround = &p->level[c + d];
			struct level m = level_new(centre->width, centre->height);
			for (int y = 0; y < m.height; y++)
				for (int x = 0; x < m.width; x++)
					m.px[y * m.width + x] = fabsf(at(centre, x, y) - resampled(surround, x, y, m.width, m.height));
			promote(&m);
			for (int y = 0; y < out->height; y++)
				for (int x = 0; x < out->width; x++)
					out->px[y * out->width + x] += resampled(&m, x, y, out->width, out->height);
			free(m.px);
		}
}

/* Energy of one orientation at every level from FIRST on: Gabor functions of wavelength 7 px, sigma 7/3 px (Itti's), cosine
 * and sine, made zero-mean so that uniform light gives no response. */
static struct pyramid oriented(const struct pyramid *intensity, int angle)
{
	struct pyramid out = { 0 };
	double theta = M_PI * angle / ANGLES, mean = 0, weight = 0;
	float cosine[GABOR][GABOR], sine[GABOR][GABOR];
	for (int j = 0; j < GABOR; j++)
		for (int i = 0; i < GABOR; i++) {
			double x = i - GABOR / 2, y = j - GABOR / 2, w = exp(-(x * x + y * y) / (2 * 49 / 9.0));
			double phase = 2 * M_PI / 7 * (x * cos(theta) + y * sin(theta));
			cosine[j][i] = (float)(w * cos(phase));
			sine[j][i] = (float)(w * sin(phase));
			mean += w * cos(phase);
			weight += w;
		}
	for (int j = 0; j < GABOR; j++)
		for (int i = 0; i < GABOR; i++) {
			double x = i - GABOR / 2, y = j - GABOR / 2;
			cosine[j][i] -= (float)(mean / weight * exp(-(x * x + y * y) / (2 * 49 / 9.0)));
		}
	for (int l = 0; l < LEVELS; l++) {
		const struct level *in = &intensity->level[l];
		out.level[l] = level_new(in->width, in->height);
		for (int y = 0; y < in->height && l >= FIRST; y++)
			for (int x = 0; x < in->width; x++) {
				float a = 0, b = 0;
				for (int j = 0; j < GABOR; j++)
					for (int i = 0; i < GABOR; i++) {
						float v = at(in, x + i - GABOR / 2, y + j - GABOR / 2);
						a += cosine[j][i] * v;
						b += sine[j][i] * v;
					}
				out.level[l].px[y * in->width + x] = sqrtf(a * a + b * b);
			}
	}
	return out;
}

/* Lateral inhibition of orientations at a place, as in the visual cortex: each keeps what exceeds their mean. */
static void compete(struct pyramid o[ANGLES])
{
	for (int l = FIRST; l < LEVELS; l++)
		for (int i = 0; i < o[0].level[l].width * o[0].level[l].height; i++) {
			float mean = 0;
			for (int a = 0; a < ANGLES; a++)
				mean += o[a].level[l].px[i] / ANGLES;
			for (int a = 0; a < ANGLES; a++)
				o[a].level[l].px[i] = fmaxf(o[a].level[l].px[i] - mean, 0);
		}
}

/* The picture at the working size: red, green, blue 0..1, averaged over the pixels that coincide. */
static void shrink(struct level rgb[3], const unsigned char *px, int width, int height, int stride)
{
	int longer = width > height ? width : height, size = longer < SALIENCY_SIZE ? longer : SALIENCY_SIZE;
	int w = (int)fmax(1, (double)width * size / longer), h = (int)fmax(1, (double)height * size / longer);
	int *count = mem_new((size_t)(w * h), sizeof *count);
	for (int c = 0; c < 3; c++)
		rgb[c] = level_new(w, h);
	for (int y = 0; y < height; y++)
		for (int x = 0; x < width; x++) {
			int i = (int)((long)y * h / height) * w + (int)((long)x * w / width);
			const unsigned char *from = px + (long)y * stride + 3L * x;
			count[i]++;
			for (int c = 0; c < 3; c++)
				rgb[c].px[i] += from[c] / 255.0f;
		}
	for (int i = 0; i < w * h; i++)
		for (int c = 0; c < 3; c++)
			rgb[c].px[i] /= (float)(count[i] ? count[i] : 1);
	free(count);
}

/* Intensity and the two colour opponencies; these are 0 where intensity is below a tenth of the maximum. */
static void channels(struct level *intensity, struct level *rg, struct level *by, const struct level rgb[3])
{
	int n = rgb[0].width * rgb[0].height;
	float top = 0;
	*intensity = level_new(rgb[0].width, rgb[0].height);
	*rg = level_new(rgb[0].width, rgb[0].height);
	*by = level_new(rgb[0].width, rgb[0].height);
	for (int i = 0; i < n; i++) {
		intensity->px[i] = (rgb[0].px[i] + rgb[1].px[i] + rgb[2].px[i]) / 3;
		top = fmaxf(top, intensity->px[i]);
	}
	for (int i = 0; i < n; i++) {
		float light = intensity->px[i];
		if (light <= 0.1f * top || light <= 0)
			continue;
		float r = rgb[0].px[i] / light, g = rgb[1].px[i] / light, b = rgb[2].px[i] / light;
		float red = fmaxf(0, r - (g + b) / 2), green = fmaxf(0, g - (r + b) / 2), blue = fmaxf(0, b - (r + g) / 2);
		float yellow = fmaxf(0, (r + g) / 2 - fabsf(r - g) / 2 - b);
		rg->px[i] = red - green;
		by->px[i] = blue - yellow;
	}
}

/* |difference from the last frame|; the last frame becomes this one. */
static bool flicker_of(struct level *out, struct saliency *s, const struct level *intensity)
{
	int n = intensity->width * intensity->height;
	bool have = s->last && s->last_width == intensity->width && s->last_height == intensity->height;
	*out = level_new(intensity->width, intensity->height);
	for (int i = 0; i < n && have; i++)
		out->px[i] = fabsf(intensity->px[i] - s->last[i]);
	if (!have)
		s->last = mem_grow(s->last, (size_t)n, sizeof *s->last);
	memcpy(s->last, intensity->px, (size_t)n * sizeof *s->last);
	s->last_width = intensity->width;
	s->last_height = intensity->height;
	return have;
}

/* One feature's conspicuity, promoted, into the map. */
static void add_conspicuity(struct saliency *s, struct level *of)
{
	promote(of);
	for (int i = 0; i < s->width * s->height; i++)
		s->map[i] += of->px[i];
	memset(of->px, 0, (size_t)(s->width * s->height) * sizeof *of->px);
}

static void set_size(struct saliency *s, const struct level *map)
{
	if (s->map && s->width == map->width && s->height == map->height) {
		memset(s->map, 0, (size_t)(s->width * s->height) * sizeof *s->map);
		return;
	}
	free(s->map);
	free(s->inhibited);
	s->width = map->width;
	s->height = map->height;
	s->map = mem_new((size_t)(s->width * s->height), sizeof *s->map);
	s->inhibited = mem_new((size_t)(s->width * s->height), sizeof *s->inhibited);
}

void saliency_push(struct saliency *s, const unsigned char *px, int width, int height, int stride)
{
	struct level rgb[3], base[4];
	struct pyramid p[4];
	shrink(rgb, px, width, height, stride);
	channels(&base[0], &base[1], &base[2], rgb);
	bool moving = flicker_of(&base[3], s, &base[0]);
	for (int i = 0; i < 4; i++)
		p[i] = pyramid_new(base[i]);
	set_size(s, &p[0].level[MAP_LEVEL]);
	struct level sum = level_new(s->width, s->height);
	centre_surround(&sum, &p[0]);
	add_conspicuity(s, &sum);
	centre_surround(&sum, &p[1]);
	centre_surround(&sum, &p[2]);
	add_conspicuity(s, &sum);
	struct level all = level_new(s->width, s->height);
	struct pyramid o[ANGLES];
	for (int a = 0; a < ANGLES; a++)
		o[a] = oriented(&p[0], a);
	compete(o);
	for (int a = 0; a < ANGLES; a++) {
		centre_surround(&sum, &o[a]);
		promote(&sum);
		for (int i = 0; i < s->width * s->height; i++)
			all.px[i] += sum.px[i];
		memset(sum.px, 0, (size_t)(s->width * s->height) * sizeof *sum.px);
		pyramid_free(&o[a]);
	}
	add_conspicuity(s, &all);
	if (moving) {
		centre_surround(&sum, &p[3]);
		add_conspicuity(s, &sum);
	}
	for (int i = 0; i < s->width * s->height; i++)
		s->map[i] /= 3 + moving;
	for (int i = 0; i < 4; i++)
		pyramid_free(&p[i]);
	for (int c = 0; c < 3; c++)
		free(rgb[c].px);
	free(sum.px);
	free(all.px);
}

void saliency_free(struct saliency *s)
{
	free(s->map);
	free(s->inhibited);
	free(s->last);
	*s = (struct saliency){ 0 };
}
