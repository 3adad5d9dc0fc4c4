#include "track/clip/beside.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/chol.h"
#include "math/stats.h"

enum { TERMS = 3, ROUNDS = 6, LEAST_FRAMES = 20 };

/* Reach of the Gaussian weight of skin about a place, as a share of the opening's width; sum of weights that counts as full. */
static const double reach_share = 0.055, full = 0.15;
/* Share of the opening's width that a corner moves by, about how it moves with gaze, at most: 2 mm. */
static const double corner_moves = 0.07;
/* Openness of an open eye. */
static const double open_enough = 0.8;
/* Radians: ridge where gaze hardly moves. px: noise floor of skin measurements. */
static const double still_gaze = 0.01, least_scale = 0.3;

/* Motion of a point of skin relative to the rigid head since the reference, px. */
static bool own(double moved[2], const struct track_result *r, const struct track_clip *clip, const struct track_points *points, long frame, int i)
{
	double now[2], was[2];
	long at = frame * r->n_points + i, at0 = clip->reference * r->n_points + i;
	if (!head_project(now, &clip->camera, r->pose[frame], points->head[i]) || !head_project(was, &clip->camera, clip->cam_from_head, points->head[i]))
		return false;
	for (int k = 0; k < 2; k++)
		moved[k] = (double)r->skin[at][k] - now[k] - (double)r->skin[at0][k] + was[k];
	return true;
}

/* The mean motion of the skin near a place, frame by frame. */
static void gather(double (*moved)[2], double *weight, const double head[3], double reach, const struct track_result *r, const struct track_clip *clip,
                   const struct track_points *points)
{
	for (int i = 0; i < points->n; i++) {
		double d2 = 0, m[2];
		for (int k = 0; k < 3; k++)
			d2 += pow(points->head[i][k] - head[k], 2);
		for (long f = 0; f < r->n && d2 < 9 * reach * reach; f++) {
			double w = (double)r->confidence[f * r->n_points + i] * exp(-d2 / (reach * reach));
			if (!(w > 1e-6) || !own(m, r, clip, points, f, i))
				continue;
			weight[f] += w;
			for (int k = 0; k < 2; k++)
				moved[f][k] += w * m[k];
		}
	}
	for (long f = 0; f < r->n; f++) {
		for (int k = 0; k < 2; k++)
			moved[f][k] /= fmax(weight[f], 1e-12);
		weight[f] = fmin(1, weight[f] / full);
	}
}

/* Interpolates linearly over frames in which no skin is seen. */
static void fill(long n, double (*moved)[2], const double *weight)
{
	long last = -1;
	for (long f = 0; f <= n; f++) {
		if (f < n && !(weight[f] > 0))
			continue;
		for (long i = last + 1; i < f; i++)
			for (int k = 0; k < 2; k++) {
				double a = last < 0 ? (f < n ? moved[f][k] : 0) : moved[last][k], b = f < n ? moved[f][k] : a;
				moved[i][k] = a + (b - a) * (double)(i - last) / (double)(f - last);
			}
		last = f;
	}
}

static bool terms(double t[TERMS], const struct eye_state *s)
{
	t[0] = 1;
	t[1] = s->gaze[0];
	t[2] = s->gaze[1];
	return isfinite(t[1]) && isfinite(t[2]) && s->openness > open_enough && s->blink == BLINK_OPEN;
}

/* One round of weighted least squares: moved = c . terms. Returns how many frames were used. */
static int round_of(double c[2][TERMS], double *off, double scale, const struct track_result *r, int side, const double (*moved)[2], const double *weight)
{
	double H[TERMS][TERMS] = { { 0 } }, b[2][TERMS] = { { 0 } }, t[TERMS], sum = 0;
	int n = 0;
	for (long f = 0; f < r->n; f++) {
		if (!(weight[f] > 0) || r->lost_at[f] || !terms(t, &r->eyes.state[f][side]))
			continue;
		double e[2] = { moved[f][0], moved[f][1] };
		for (int k = 0; k < 2; k++)
			for (int a = 0; a < TERMS; a++)
				e[k] -= c[k][a] * t[a];
		off[n] = hypot(e[0], e[1]);
		double w = weight[f] / (1 + pow(off[n++] / scale, 4));
		sum += w;
		for (int a = 0; a < TERMS; a++) {
			for (int d = 0; d < TERMS; d++)
				H[a][d] += w * t[a] * t[d];
			for (int k = 0; k < 2; k++)
				b[k][a] += w * t[a] * moved[f][k];
		}
	}
	for (int a = 1; a < TERMS; a++)
		H[a][a] += sum * still_gaze * still_gaze;
	for (int k = 0; k < 2 && n >= LEAST_FRAMES; k++) {
		double m[TERMS][TERMS];
		memcpy(m, H, sizeof m);
		if (chol_solve(TERMS, TERMS, &m[0][0], b[k]))
			memcpy(c[k], b[k], sizeof c[k]);
	}
	return n;
}

/* How the skin moves with gaze, by regression over the clip: moved = c . terms. False where too little of it is seen. */
static bool with_gaze(double c[2][TERMS], const double (*moved)[2], const double *weight, const struct track_result *r, int side, double *room)
{
	double scale = 1e9;
	memset(c, 0, sizeof(double[2][TERMS]));
	for (int round = 0; round < ROUNDS; round++) {
		int n = round_of(c, room, scale, r, side, moved, weight);
		if (n < LEAST_FRAMES)
			return false;
		scale = round ? 2 * fmax(least_scale, stats_median(n, room)) : 1e9;
	}
	return true;
}

/* Where too few frames tell how it moves with gaze: the median of those. */
static void without_gaze(double c[2][TERMS], const double (*moved)[2], const double *weight, long frames, double *room)
{
	for (int k = 0; k < 2; k++) {
		int n = 0;
		for (long f = 0; f < frames; f++)
			if (weight[f] > 0)
				room[n++] = moved[f][k];
		c[k][0] = n ? stats_median(n, room) : 0;
		c[k][1] = c[k][2] = 0;
	}
}

/* A corner moves by a millimetre or two: skin that says otherwise was lost there. */
static void drop_far(double *weight, const double (*moved)[2], double c[2][TERMS], double most, const struct track_result *r, int side)
{
	for (long f = 0; f < r->n; f++) {
		double t[TERMS], e[2] = { moved[f][0], moved[f][1] };
		const int known = terms(t, &r->eyes.state[f][side]) ? TERMS : 1;
		for (int k = 0; k < 2; k++)
			for (int a = 0; a < known; a++)
				e[k] -= c[k][a] * t[a];
		if (hypot(e[0], e[1]) > most)
			weight[f] = 0;
	}
}

/* The mesh's face looks straight on; in the reference frame the eye may look to the side and has pulled the skin along. Adds
 * that motion; horizontally alone: the mesh's lids are assumed as high as at the reference. */
static void from_straight(double (*moved)[2], double c[2][TERMS], const struct track_result *r, int side, const struct track_clip *clip)
{
	const double h = r->eyes.state[clip->reference][side].gaze[0];
	for (long f = 0; f < r->n && isfinite(h); f++)
		for (int k = 0; k < 2; k++)
			moved[f][k] += c[k][1] * h;
}

struct beside beside_new(int n, const double (*head)[3], const struct track_result *r, int side, const struct track_clip *clip,
                         const struct track_points *points)
{
	size_t all = (size_t)n * (size_t)r->n + 1;
	struct beside b = { n, r->n, bulk_new(r->bulk, all, sizeof *b.moved), bulk_new(r->bulk, all, sizeof *b.weight), r->bulk };
	double *room = mem_array((size_t)r->n + 1, sizeof *room), wide = 0, ends[2][2], c[2][TERMS];
	const bool seen = head_project(ends[0], &clip->camera, clip->cam_from_head, head[0]) && head_project(ends[1], &clip->camera, clip->cam_from_head, head[n - 1]);
	for (int k = 0; k < 3; k++)
		wide += pow(head[n - 1][k] - head[0][k], 2);
	for (int i = 0; i < n; i++) {
		double(*moved)[2] = b.moved + i * r->n, *weight = b.weight + i * r->n;
		gather(moved, weight, head[i], reach_share * sqrt(wide), r, clip, points);
		const bool told = with_gaze(c, (const double(*)[2])moved, weight, r, side, room);
		if (!told)
			without_gaze(c, (const double(*)[2])moved, weight, r->n, room);
		if (seen && (i == 0 || i == n - 1))
			drop_far(weight, (const double(*)[2])moved, c, corner_moves * hypot(ends[0][0] - ends[1][0], ends[0][1] - ends[1][1]), r, side);
		fill(r->n, moved, weight);
		if (told)
			from_straight(moved, c, r, side, clip);
	}
	free(room);
	return b;
}

void beside_free(struct beside *b)
{
	bulk_free(b->bulk, b->moved);
	bulk_free(b->bulk, b->weight);
}
