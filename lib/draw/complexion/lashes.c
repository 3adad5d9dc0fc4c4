/* Lashes in a frame: what is thin and dark beside the lids' margins, and runs away from them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/complexion/impl.h"
#include "image/image.h"
#include "math/stats.h"

/* Rows go away from the margin, columns along it, mm; creases of the lid run along it and are no lashes. Lashes stand no further apart than
 * between_mm. Lashes end, and brows do not yet begin, at far_mm of the upper and the lower lid. */
static const double row_mm = 0.1, column_mm = 0.08, between_mm = 1.0, far_mm[2] = { 11, 8 }, near_mm = 2;
static const double inner_share = 0.1, outer_share = 0.97;  // of a margin, from the inner corner: what is looked at
static const double px_mm_least = 2.5, spread_mm = 1.2;      // a lash is some tenth of a mm wide
/* Of the area of upper and lower lashes so much is seen as darker than what is beside it: they lie over each other, and stand too close at their roots to
 * show the skin between them. Measured on 13 heads of known lashes by another renderer. */
static const double area_seen[2] = { 0.35, 0.5 };
static const double rows_smooth_mm = 0.3, cover_most = 0.9;
/* From so far off the margin up to where they hide most, lashes hide at least that share of it: else what is darkest is something else, or the margin is not there. */
static const double from_mm = 1, least_share = 0.5;
enum { ROWS = 110, COLUMNS = 600, LEAST_COLUMNS = 120, MOST_POINTS = 512 };

/* A margin, so many points along it, each with the direction out of the opening. */
struct margin {
	int n;
	double at[COLUMNS][2], out[COLUMNS][2];
};

static bool lay(struct margin *g, const float (*p)[2], int n, double step, double down)
{
	double along[MOST_POINTS], raw[COLUMNS][2];
	along[0] = 0;
	for (int i = 1; i < n; i++)
		along[i] = along[i - 1] + hypot((double)(p[i][0] - p[i - 1][0]), (double)(p[i][1] - p[i - 1][1]));
	g->n = (int)fmin(along[n - 1] / step, COLUMNS);
	if (!isfinite(along[n - 1]) || g->n < LEAST_COLUMNS)
		return false;
	for (int i = 0, k = 0; i < g->n; i++) {
		while (k + 2 < n && along[k + 1] < i * step)
			k++;
		const double t = (i * step - along[k]) / fmax(along[k + 1] - along[k], 1e-9);
		for (int c = 0; c < 2; c++)
			raw[i][c] = g->at[i][c] = (double)p[k][c] + t * (double)(p[k + 1][c] - p[k][c]);
	}
	// Its direction, over a tenth of its length: points have errors.
	const int reach = g->n / 20 + 1;
	for (int i = 0; i < g->n; i++) {
		const int a = i > reach ? i - reach : 0, b = i + reach < g->n ? i + reach : g->n - 1;
		const double dx = raw[b][0] - raw[a][0], dy = raw[b][1] - raw[a][1], sign = dx * down > 0 ? 1 : -1, len = fmax(hypot(dx, dy), 1e-9);
		g->out[i][0] = -sign * dy / len;
		g->out[i][1] = sign * dx / len;
	}
	return true;
}

/* Luminance at a place of a frame; NAN beyond it. */
static double at_px(const struct complexion_view *v, const float linear[256], double x, double y)
{
	const int u = (int)floor(x - 0.5), w = (int)floor(y - 0.5);
	const double fx = x - 0.5 - u, fy = y - 0.5 - w;
	double sum = 0;
	if (u < 0 || w < 0 || u + 1 >= v->width || w + 1 >= v->height)
		return NAN;
	for (int j = 0; j < 4; j++) {
		const uint8_t *p = v->rgb + 3 * ((long)(w + j / 2) * v->width + u + j % 2);
		sum += (j % 2 ? fx : 1 - fx) * (j / 2 ? fy : 1 - fy) * (0.2126 * (double)linear[p[0]] + 0.7152 * (double)linear[p[1]] + 0.0722 * (double)linear[p[2]]);
	}
	return sum;
}

/* The share that hairs hide of a row: what is darker than its surroundings along it (a closing), as hairs that lie over each other have it. */
static double row_cover(const double *y, int n, int first, int last, int reach)
{
	double high[COLUMNS], sum = 0;
	int many = 0;
	for (int i = 0; i < n; i++) {
		high[i] = y[i];
		for (int k = i > reach ? i - reach : 0; k <= i + reach && k < n; k++)
			high[i] = fmax(high[i], y[k]);
	}
	for (int i = first; i < last; i++) {
		double low = INFINITY;
		for (int k = i > reach ? i - reach : 0; k <= i + reach && k < n; k++)
			low = fmin(low, high[k]);
		if (low > 0 && isfinite(y[i])) {
			sum += fmin(1 - y[i] / low, 1);
			many++;
		}
	}
	return many * 2 > last - first ? -log1p(-fmin(sum / many, cover_most)) : NAN;
}

/* Of one margin, from the inner corner on or from the outer; px_mm: px in a mm. */
static struct hair_lid of_margin(const struct complexion_view *v, const float (*margin)[2], bool upper, bool inner_first, double px_mm)
{
	const struct hair_lid none = { 0, 0 };
	struct margin *g = mem_new(1, sizeof *g);
	double (*y)[COLUMNS] = mem_new(ROWS, sizeof *y), cover[ROWS], smooth[ROWS], area = 0, sum = 0;
	float linear[256];
	const int rows = (int)lrint(far_mm[!upper] / row_mm), r = (int)lrint(rows_smooth_mm / row_mm);
	bool ok = px_mm >= px_mm_least && v->lid_points >= 3 && v->lid_points <= MOST_POINTS && lay(g, margin, v->lid_points, column_mm * px_mm, upper ? -1 : 1);
	for (int i = 0; i < 256; i++)
		linear[i] = linear_from_srgb((float)i / 255);
	const double first = inner_first ? inner_share : 1 - outer_share, last = inner_first ? outer_share : 1 - inner_share;
	for (int j = 0; j < rows && ok; j++) {
		double stretch = 0;  // rows further out are longer
		for (int i = 0; i < g->n; i++) {
			const double s = j * row_mm * px_mm, x = g->at[i][0] + s * g->out[i][0], z = g->at[i][1] + s * g->out[i][1];
			y[j][i] = at_px(v, linear, x, z);
			if (i)
				stretch += hypot(x - g->at[i - 1][0] - s * g->out[i - 1][0], z - g->at[i - 1][1] - s * g->out[i - 1][1]);
		}
		stretch /= column_mm * px_mm * (g->n - 1);
		cover[j] = stretch * row_cover(y[j], g->n, (int)(first * g->n), (int)(last * g->n), (int)lrint(between_mm / column_mm / fmax(stretch, 0.5)));
		ok = isfinite(cover[j]);
	}
	// Grain of skin and film is as dark where no lashes are any more.
	int end = (int)lrint(near_mm / row_mm);
	for (int j = 0; j < rows && ok; j++) {
		int many = 0;
		smooth[j] = 0;
		for (int k = j > r ? j - r : 0; k <= j + r && k < rows; k++, many++)
			smooth[j] += cover[k];
		smooth[j] /= many;
		if (j > end && smooth[j] < smooth[end])
			end = j;
	}
	int darkest = 0;
	for (int j = 0; j < end && ok; j++)
		darkest = smooth[j] > smooth[darkest] ? j : darkest;
	for (int j = (int)lrint(from_mm / row_mm); j < darkest && ok; j++)
		ok = smooth[j] - smooth[end] >= least_share * (smooth[darkest] - smooth[end]);
	for (int j = 0; j < end && ok; j++) {
		const double own = fmax(cover[j] - smooth[end], 0) * row_mm;
		area += own;
		sum += own * (j + 0.5) * row_mm;
	}
	free(y);
	free(g);
	return ok && area > 0 ? (struct hair_lid){ area / area_seen[!upper], sum / area } : none;
}

/* px of a mm at an eye, and the middle of its opening; false: not known. */
static bool about_eye(double *px_mm, double middle[2][2], const struct complexion *c, const struct complexion_view *v)
{
	double depth[2] = { 0, 0 };
	int n[2] = { 0, 0 };
	for (int i = 0; i < c->mesh->n_vertices; i++)
		for (int s = 0; s < 2; s++) {
			const float *x = c->mesh->vertices[i];
			if (hypot((double)x[0] - c->eye[s][0], (double)x[1] - c->eye[s][1]) < spread_mm * c->radius && isfinite(v->at[i][2]) && v->at[i][2] > 0) {
				depth[s] += (double)v->at[i][2];
				n[s]++;
			}
		}
	for (int s = 0; s < 2; s++) {
		if (!n[s])
			return false;
		px_mm[s] = v->focal_px * n[s] / depth[s];
		middle[s][0] = middle[s][1] = 0;
		for (int i = 0; i < v->lid_points; i++)
			for (int k = 0; k < 2; k++)
				middle[s][k] += (double)v->lids[2 * s * v->lid_points + i][k] / v->lid_points;
	}
	return isfinite(middle[0][0] + middle[0][1] + middle[1][0] + middle[1][1]);
}

void complexion_add_lashes(struct complexion *c, const struct complexion_view *v)
{
	double px_mm[2], middle[2][2];
	if (!v->lids || v->lid_points < 3 || !about_eye(px_mm, middle, c, v))
		return;
	const double unit = c->radius / 12;  // people of other sizes, and meshes in other units, are alike in eyeballs
	for (int s = 0; s < 2; s++) {
		const float (*up)[2] = v->lids + 2 * s * v->lid_points, (*low)[2] = up + v->lid_points;
		const int m = v->lid_points / 2, e = v->lid_points - 1;
		const double *other = middle[1 - s];
		const bool inner_first = hypot((double)up[0][0] - other[0], (double)up[0][1] - other[1]) < hypot((double)up[e][0] - other[0], (double)up[e][1] - other[1]);
		struct complexion_lashes *to = &c->lashes[c->n_lashes++];
		to->open = hypot((double)(up[m][0] - low[m][0]), (double)(up[m][1] - low[m][1])) / px_mm[s];
		to->lid[HAIR_UPPER] = of_margin(v, up, true, inner_first, px_mm[s] * unit);
		to->lid[HAIR_LOWER] = of_margin(v, low, false, inner_first, px_mm[s] * unit);
	}
}

void complexion_lashes_mean(struct hair_lid lid[2], const struct complexion *c)
{
	double widest = 0;
	for (int i = 0; i < c->n_lashes; i++)
		widest = fmax(widest, c->lashes[i].open);
	for (int kind = HAIR_UPPER; kind <= HAIR_LOWER; kind++) {
		double area[COUNT(c->lashes)], reach[COUNT(c->lashes)];
		int n = 0;
		for (int i = 0; i < c->n_lashes; i++)
			// A lid that is lower points its lashes at the camera.
			if (c->lashes[i].open >= 0.85 * widest && c->lashes[i].lid[kind].area > 0) {
				area[n] = c->lashes[i].lid[kind].area;
				reach[n++] = c->lashes[i].lid[kind].reach;
			}
		lid[kind] = n ? (struct hair_lid){ stats_median(n, area), stats_median(n, reach) } : (struct hair_lid){ 0, 0 };
	}
}
