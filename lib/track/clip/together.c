#include "track/clip/together.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"
#include "track/head/pose.h"
#include "track/clip/scale.h"

/* Patches slide together, too, where all about them are shaded alike: on three rendered heads points of whose neighbours a fifth or less was seen were off by 5 px in the
 * median, those with a fifth to two fifths by 2, those with most of them by half a pixel. */
static const double least_seen = 1.0 / 3;

/* A point about the rigid head in one frame. */
struct about {
	double rigid[2], off[2];  // px: where the head alone puts it; how far from there it was found
	double weight;            // confidence squared; 0: not seen
};

/* What a point's neighbours, and it itself, tell of its motion about the head. */
struct field {
	double off[2], scatter;   // px
};

/* Component-wise median of the neighbours. */
static void middle(double mid[2], int n, const int who[], const struct about *a)
{
	double x[SKIN_NEAR_MAX + 1];
	for (int c = 0; c < 2; c++) {
		for (int k = 0; k < n; k++)
			x[k] = a[who[k]].off[c];
		mid[c] = stats_median(n, x);
	}
}

/* How much a point's neighbours count by their distance in the reference: [link], as p->near. free(). */
static double *closeness(const struct skin_points *p)
{
	double *close = mem_array((size_t)p->first[p->n] + 1, sizeof *close);
	for (int i = 0; i < p->n; i++) {
		double reach = 0;
		for (int k = p->first[i]; k < p->first[i + 1]; k++) {
			const double *at = p->at[p->near[k]];
			close[k] = hypot(at[0] - p->at[i][0], at[1] - p->at[i][1]);
			reach = fmax(reach, close[k]);
		}
		for (int k = p->first[i]; k < p->first[i + 1]; k++) {
			const double d = close[k] / (reach / 1.5);
			close[k] = exp(-0.5 * d * d);
		}
	}
	return close;
}

/* Tukey's weighted mean about the median: one step. close: of closeness(). Returns false where too few are seen. */
static bool mean_motion(struct field *out, int i, const struct about *a, const struct skin_points *p, const double *close, double least_px)
{
	enum { LEAST = 4 };
	int who[SKIN_NEAR_MAX + 1], n = 0;
	double r[SKIN_NEAR_MAX + 1], order[SKIN_NEAR_MAX + 1], nearness[SKIN_NEAR_MAX + 1], mid[2], sum = 0, square = 0;
	for (int k = p->first[i]; k < p->first[i + 1] && n < SKIN_NEAR_MAX; k++)
		if (a[p->near[k]].weight > 0) {
			nearness[n] = close[k];
			who[n++] = p->near[k];
		}
	if (n < LEAST)
		return false;
	if (a[i].weight > 0) {
		nearness[n] = 1;
		who[n++] = i;
	}
	n = n < SKIN_NEAR_MAX + 1 ? n : SKIN_NEAR_MAX + 1;
	assert(n > 0);
	middle(mid, n, who, a);
	for (int k = 0; k < n; k++)
		order[k] = r[k] = sqrt(pow(a[who[k]].off[0] - mid[0], 2) + pow(a[who[k]].off[1] - mid[1], 2));
	double scale = 4.5 * fmax(least_px, stats_median(n, order));
	*out = (struct field){ 0 };
	for (int k = 0; k < n; k++) {
		const double *off = a[who[k]].off;
		double e = r[k] / scale, w = e < 1 ? a[who[k]].weight * nearness[k] * pow(1 - e * e, 2) : 0;
		for (int c = 0; c < 2; c++)
			out->off[c] += w * off[c];
		square += w * (off[0] * off[0] + off[1] * off[1]);
		sum += w;
	}
	if (!(sum > 0))
		return false;
	out->off[0] /= sum;
	out->off[1] /= sum;
	out->scatter = sqrt(fmax(0, square / sum - out->off[0] * out->off[0] - out->off[1] * out->off[1]));
	return true;
}

/* Neighbours err half alike: their mean is about as far off as they scatter. Skin off the lids mostly stands still about the head: it moves as they do as far as that is more. */
static void still(struct field *f)
{
	const double moved = f->off[0] * f->off[0] + f->off[1] * f->off[1], share = moved > 0 ? moved / (moved + f->scatter * f->scatter) : 0;
	f->off[0] *= share;
	f->off[1] *= share;
}

/* A point that is seen alone is not believed. */
static void leave_alone(struct about *a, float *confidence, const struct skin_points *p)
{
	for (int i = 0; i < p->n; i++)
		a[i].weight = confidence[i] > 0;
	for (int i = 0; i < p->n; i++) {
		const int all = p->first[i + 1] - p->first[i];
		double seen = 0;
		for (int k = p->first[i]; k < p->first[i + 1]; k++)
			seen += a[p->near[k]].weight;
		if (seen < least_seen * all)
			confidence[i] = 0;
	}
}

static void frame(struct track_result *r, long f, struct about *a, const struct track_points *points, const double *close, const bool *lid, const struct track_clip *clip,
                  double own, double astray)
{
	float (*skin)[2] = r->skin + f * r->n_points, *confidence = r->confidence + f * r->n_points;
	for (int i = 0; i < r->n_points; i++) {
		bool ahead = head_project(a[i].rigid, &clip->camera, r->pose[f], points->head[i]);
		a[i].weight = ahead ? pow((double)confidence[i], 2) : 0;
		for (int c = 0; c < 2; c++)
			a[i].off[c] = (double)skin[i][c] - a[i].rigid[c];
	}
	for (int i = 0; i < r->n_points; i++) {
		struct field field;
		if (!mean_motion(&field, i, a, &points->points, close, own))
			continue;
		if (!lid[i])
			still(&field);
		double d[2] = { a[i].off[0] - field.off[0], a[i].off[1] - field.off[1] }, off = hypot(d[0], d[1]) / astray;
		double trust = a[i].weight > 0 && off < 2 ? exp(-0.5 * off * off) : 0, keep = trust * own * own / (own * own + field.scatter * field.scatter);
		double px[2];
		for (int c = 0; c < 2; c++) {
			px[c] = a[i].rigid[c] + field.off[c] + keep * d[c];
			skin[i][c] = (float)px[c];
		}
		confidence[i] = (float)((double)confidence[i] * trust);
		track_to_model(r->skin_model[f * r->n_points + i], px, points->head[i], r->pose[f], clip);
	}
	leave_alone(a, confidence, &points->points);
}

void track_together(struct track_result *r, const struct track_points *points, const struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf)
{
	double *close = closeness(&points->points);
	bool *lid = mem_new((size_t)r->n_points + 1, sizeof *lid);
	for (int i = 0; i < r->n_points; i++)
		lid[i] = track_on_lid(points->head[i], s);
#pragma omp parallel
	{
		struct about *a = mem_array((size_t)r->n_points + 1, sizeof *a);
#pragma omp for schedule(dynamic, 4)
		for (long f = 0; f < r->n; f++)
			if (!r->lost_at[f]) {
				const double px_per_mm = track_px_per_mm(clip, (const double(*)[4])r->pose[f], s);
				frame(r, f, a, points, close, lid, clip, conf->own_mm * px_per_mm, conf->astray_mm * px_per_mm);
			}
		free(a);
	}
	free(close);
	free(lid);
}
