#include "iris/unrefract/polar.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum { COLUMNS_MIN = 256, COLUMNS_MAX = 4096, ENOUGH = 10 };  // a row is full where a tenth of it is seen
static const float darkest = 2e-4f;  // of full scale; below it the logarithm is noise
static const float seen_from = 0.5f; // weight from which a texel counts as seen

/* How far the limbus lies from the pupil's centre along a ray, mm. */
static double reach_of(const struct sheet *sheet, double phi)
{
	double p[2];
	sheet_point(p, sheet, 1, phi);
	return hypot(p[0] - sheet->pupil.cx, p[1] - sheet->pupil.cy);
}

/* Colour and weight of the texture at a point, bilinear among texels that are seen. */
static bool take(float rgb[3], const struct image *rgbw, double extent, const double at[2])
{
	double to = rgbw->width / (2 * extent), u = (at[0] + extent) * to - 0.5, v = (at[1] + extent) * to - 0.5;
	int x = (int)floor(u), y = (int)floor(v);
	if (x < 0 || y < 0 || x + 1 >= rgbw->width || y + 1 >= rgbw->height)
		return false;
	float fx = (float)(u - x), fy = (float)(v - y), weight = 0;
	rgb[0] = rgb[1] = rgb[2] = 0;
	for (int k = 0; k < 4; k++) {
		const float *px = image_at(rgbw, x + k % 2, y + k / 2);
		float w = (k % 2 ? fx : 1 - fx) * (k / 2 ? fy : 1 - fy);
		if (px[3] < seen_from)
			continue;
		weight += w;
		for (int c = 0; c < 3; c++)
			rgb[c] += w * px[c];
	}
	for (int c = 0; c < 3; c++)
		rgb[c] = logf(fmaxf(rgb[c] / fmaxf(weight, 1e-6f), darkest));
	return weight > 0.5f;
}

static void read_row(struct polar *p, int row, const struct unrefract_texture *texture)
{
	double sum[3] = { 0 };
	int n = 0;
	for (int j = 0; j < p->columns; j++) {
		double at[2];
		float *px = polar_at(p, row, j);
		sheet_point(at, &p->sheet, (row + 0.5) / p->rows, 2 * M_PI * (j + 0.5) / p->columns);
		bool seen = take(px, &texture->rgbw, texture->extent, at);
		*polar_kind(p, row, j) = seen ? POLAR_SEEN : POLAR_HIDDEN;
		for (int c = 0; c < 3 && seen; c++)
			sum[c] += px[c];
		n += seen;
	}
	p->full[row] = n > p->columns / ENOUGH ? row : -1;
	for (int c = 0; c < 3; c++)
		p->level[row][c] = n ? (float)(sum[c] / n) : 0;
}

/* Rows of which too little is seen take the nearest full one's level. */
static void relate(struct polar *p)
{
	int *own = mem_array((size_t)p->rows, sizeof *own);
	memcpy(own, p->full, (size_t)p->rows * sizeof *own);
	for (int k = 0; k < p->rows; k++)
		for (int d = 0; d < p->rows && p->full[k] < 0; d++) {
			if (k >= d && own[k - d] >= 0)
				p->full[k] = k - d;
			else if (k + d < p->rows && own[k + d] >= 0)
				p->full[k] = k + d;
		}
	for (int k = 0; k < p->rows; k++)
		if (p->full[k] >= 0)
			memcpy(p->level[k], p->level[p->full[k]], sizeof p->level[k]);
	free(own);
}

struct polar polar_new(const struct unrefract_texture *texture, double limbus)
{
	double texel = 2 * texture->extent / texture->rgbw.width;
	struct polar p = { .sheet = { texture->rgbw.width, texture->extent, texture->pupil, limbus, 0 }, .columns = COLUMNS_MIN };
	while (p.columns < COLUMNS_MAX && p.columns < 1.6 * M_PI * limbus / texel)
		p.columns *= 2;
	p.rows = (int)fmax(8, ceil((limbus - texture->pupil.r) / texel));
	size_t n = (size_t)p.rows * (size_t)p.columns;
	p.px = mem_array(3 * n, sizeof *p.px);
	p.kind = mem_array(n, 1);
	p.level = mem_array((size_t)p.rows, sizeof *p.level);
	p.full = mem_array((size_t)p.rows, sizeof *p.full);
#pragma omp parallel for schedule(static)
	for (int k = 0; k < p.rows; k++)
		read_row(&p, k, texture);
	relate(&p);
#pragma omp parallel for schedule(static)
	for (int k = 0; k < p.rows; k++)
		for (int j = 0; j < p.columns; j++)
			for (int c = 0; c < 3; c++) {
				float *px = polar_at(&p, k, j);
				px[c] = *polar_kind(&p, k, j) == POLAR_SEEN ? px[c] - p.level[k][c] : 0;
			}
	return p;
}

void polar_free(struct polar *polar)
{
	free(polar->px);
	free(polar->kind);
	free(polar->level);
	free(polar->full);
	*polar = (struct polar){ 0 };
}

/* Catmull and Rom's weights. */
static void cubic(float w[4], float t)
{
	w[0] = t * (-0.5f + t * (1 - 0.5f * t));
	w[1] = 1 + t * t * (-2.5f + 1.5f * t);
	w[2] = t * (0.5f + t * (2 - 1.5f * t));
	w[3] = t * t * (-0.5f + 0.5f * t);
}

bool polar_colour(float rgb[3], const struct polar *p, double x, double y)
{
	const struct circle *pupil = &p->sheet.pupil;
	double dx = x - pupil->cx, dy = y - pupil->cy, phi = atan2(dy, dx);
	double t = (hypot(dx, dy) - pupil->r) / (reach_of(&p->sheet, phi) - pupil->r);
	double row = fmin(fmax(t * p->rows - 0.5, 0), p->rows - 1), column = phi / (2 * M_PI) * p->columns - 0.5 + p->columns;
	if (!(t > -0.02 && t < 1.02))
		return false;
	int k = (int)floor(row), j = (int)column;
	float across[4], along[4];
	cubic(across, (float)(row - k));
	cubic(along, (float)(column - j));
	for (int c = 0; c < 3; c++) {
		float sum = 0;
		for (int a = 0; a < 4; a++) {
			int at = k + a - 1;
			at = at < 0 ? 0 : at >= p->rows ? p->rows - 1 : at;
			float line = p->level[at][c];
			for (int b = 0; b < 4; b++)
				line += along[b] * polar_at(p, at, j + b - 1)[c];
			sum += across[a] * line;
		}
		rgb[c] = expf(sum);
	}
	return true;
}
