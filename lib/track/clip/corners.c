#include "track/clip/corners.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "track/lid/line.h"
#include "track/clip/beside.h"
#include "track/clip/blink_lower.h"
#include "track/clip/blink_upper.h"
#include "track/clip/scale.h"

enum { ENDS = 2 };

/* Shares of the distance between the corners in which the mesh gives the shape, at the inner and the outer end. */
static const double shaped[ENDS] = { 0.09, 0.14 };
/* Where a margin that is found ends nearer to the middle, as far as that and so much more; at most. */
static const double beyond = 0.02, shaped_most = 0.3;
/* Weight of the skin's motion, upper and lower lid, and the distance (mm) between it and the margin seen at which it has lost half. */
static const double believed[LIDS] = { 0.4, 1 }, near_mm = 0.3;
/* mm: no lower lid's margin is further off where its skin takes that of the reference frame (canthi.h): skin runs into it. That of the upper lid hangs over it. */
static const double far_mm = 1;

/* The margin of the mesh, both lids from the inner corner to the outer, head frame. */
struct rim {
	int n[LIDS];
	double head[LIDS][OPENING_POINTS + 2][3];
};

/* The point of the outline after which a corner lies. */
static int after(const struct eye_opening *o, const double corner[3])
{
	int best = 0;
	double least = INFINITY;
	for (int i = 0; i < OPENING_POINTS; i++) {
		const double *a = o->edge[i], *b = o->edge[(i + 1) % OPENING_POINTS];
		double way = 0;
		for (int k = 0; k < 2; k++)
			way += k ? hypot(b[0] - corner[0], b[1] - corner[1]) : hypot(a[0] - corner[0], a[1] - corner[1]);
		way -= hypot(b[0] - a[0], b[1] - a[1]);
		if (way < least) {
			least = way;
			best = i;
		}
	}
	return best;
}

static void rim_of(struct rim *rim, const struct eye_opening *o)
{
	int inner = after(o, o->canthus[0]), outer = after(o, o->canthus[1]);
	double height[2] = { 0 };
	struct rim way = { 0 };
	for (int k = 0; k < 2; k++) {
		int between = ((k ? inner - outer : outer - inner) + OPENING_POINTS) % OPENING_POINTS;
		way.n[k] = between + 2;
		memcpy(way.head[k][0], o->canthus[0], sizeof way.head[k][0]);
		memcpy(way.head[k][between + 1], o->canthus[1], sizeof way.head[k][0]);
		for (int i = 0; i < between; i++) {
			memcpy(way.head[k][1 + i], o->edge[(inner + (k ? -i : 1 + i) + OPENING_POINTS) % OPENING_POINTS], sizeof way.head[k][0]);
			height[k] += way.head[k][1 + i][1] / between;
		}
	}
	int upper = height[1] > height[0];
	for (int k = 0; k < LIDS; k++) {
		rim->n[k] = way.n[k ^ upper];
		memcpy(rim->head[k], way.head[k ^ upper], sizeof rim->head[k]);
	}
}

static bool project_rim(struct line out[LIDS], const struct rim *rim, const struct track_clip *clip, const double pose[4][4])
{
	for (int k = 0; k < LIDS; k++) {
		out[k].n = rim->n[k];
		for (int i = 0; i < rim->n[k]; i++)
			if (!head_project(out[k].p[i], &clip->camera, pose, rim->head[k][i]))
				return false;
	}
	return true;
}

/* The affine map of three points. */
static bool affine(double m[2][3], const double from[3][2], const double to[3][2])
{
	double a[2][2], b[2][2];
	for (int i = 0; i < 2; i++)
		for (int k = 0; k < 2; k++) {
			a[i][k] = from[i + 1][k] - from[0][k];
			b[i][k] = to[i + 1][k] - to[0][k];
		}
	double det = a[0][0] * a[1][1] - a[0][1] * a[1][0];
	if (fabs(det) < 1)
		return false;
	for (int k = 0; k < 2; k++) {
		m[k][0] = (b[0][k] * a[1][1] - b[1][k] * a[0][1]) / det;
		m[k][1] = (b[1][k] * a[0][0] - b[0][k] * a[1][0]) / det;
		m[k][2] = to[0][k] - m[k][0] * from[0][0] - m[k][1] * from[0][1];
	}
	return true;
}

/* Appends the mesh's margin at one end, as far as `from`, mapped by m, in the order from inner to outer. */
static void add_end(struct line *out, const struct line *mesh, const double corners[ENDS][2], int end, double from, double m[2][3])
{
	for (int i = 0; i < mesh->n; i++) {
		double u = line_along(mesh->p[i], corners[0], corners[1]), p[2];
		if (end ? u < from : u > from)
			continue;
		for (int k = 0; k < 2; k++)
			p[k] = m[k][0] * mesh->p[i][0] + m[k][1] * mesh->p[i][1] + m[k][2];
		line_add(out, p);
	}
}

/* Replaces the ends of both margins by the mesh's, mapped affinely onto the corner and the points where the margins become
 * clear. */
static void reshape(struct eye_state *state, const struct line mesh[LIDS], const double corner[ENDS][2])
{
	double from[ENDS][2], map[ENDS][2][3], at[ENDS] = { shaped[0], 1 - shaped[1] };
	struct line found[LIDS], out[LIDS] = { 0 };
	for (int c = 0; c < ENDS; c++)
		memcpy(from[c], mesh[0].p[c ? mesh[0].n - 1 : 0], sizeof from[c]);
	for (int k = 0; k < LIDS; k++) {
		found[k].n = state->lid_points;
		memcpy(found[k].p, state->lid[k], (size_t)state->lid_points * sizeof *found[k].p);
		// margins that end before the mesh's corners: its shape as far as they come
		at[0] = fmin(fmax(at[0], line_along(found[k].p[0], corner[0], corner[1]) + beyond), shaped_most);
		at[1] = fmax(fmin(at[1], line_along(found[k].p[found[k].n - 1], corner[0], corner[1]) - beyond), 1 - shaped_most);
	}
	for (int c = 0; c < ENDS; c++) {
		double a[3][2], b[3][2], u = at[c];
		memcpy(a[0], from[c], sizeof a[0]);
		memcpy(b[0], corner[c], sizeof b[0]);
		for (int k = 0; k < LIDS; k++)
			if (!line_passes(a[1 + k], &mesh[k], u, from) || !line_passes(b[1 + k], &found[k], u, corner))
				return;
		if (!affine(map[c], a, b))
			return;
	}
	for (int k = 0; k < LIDS; k++) {
		add_end(&out[k], &mesh[k], from, 0, at[0], map[0]);
		for (int i = 0; i < found[k].n; i++) {
			double u = line_along(found[k].p[i], corner[0], corner[1]);
			if (u > at[0] && u < at[1])
				line_add(&out[k], found[k].p[i]);
		}
		add_end(&out[k], &mesh[k], from, 1, at[1], map[1]);
		if (out[k].n < LIDS)
			return;
	}
	for (int k = 0; k < LIDS; k++)
		line_spread(state->lid[k], state->lid_points, &out[k]);
}

/* Averages a margin with the mesh's, carried by the skin beside it. The weight falls where the two disagree, and grows again where they do by so much that what was found
 * is no margin: reddened sclera against white, say. */
static void draw_to_skin(struct eye_state *state, int lid, const struct line *mesh, const struct beside *skin, long frame, double near_px, double far_px)
{
	struct line found = { .n = state->lid_points }, out = { .n = mesh->n };
	memcpy(found.p, state->lid[lid], (size_t)found.n * sizeof *found.p);
	for (int i = 0; i < mesh->n; i++) {
		const double *moved = beside_moved(skin, i, frame);
		double p[2] = { mesh->p[i][0] + moved[0], mesh->p[i][1] + moved[1] }, q[2];
		bool end = i == 0 || i == mesh->n - 1;
		memcpy(q, end ? found.p[i ? found.n - 1 : 0] : p, sizeof q);
		if (!end)
			line_nearest(q, &found, p);
		const double off = hypot(p[0] - q[0], p[1] - q[1]), agree = 1 / (1 + pow(off / near_px, 4)), stray = off > 0 ? 1 / (1 + pow(far_px / off, 4)) : 0;
		const double share = end ? 0 : beside_weight(skin, i, frame) * fmax(believed[lid] * agree, stray);
		for (int k = 0; k < 2; k++)
			out.p[i][k] = q[k] + share * (p[k] - q[k]);
	}
	line_spread(state->lid[lid], state->lid_points, &out);
}

static void eye(struct track_result *r, int side, const struct track_clip *clip, const struct track_subject *s, const struct track_points *points)
{
	struct rim rim;
	struct beside skin[LIDS];
	rim_of(&rim, &s->margin[side]);
	for (int k = 0; k < LIDS; k++)
		skin[k] = beside_new(rim.n[k], rim.head[k], r, side, clip, points);
	int below = rim.n[LID_LOWER];
	double(*carried)[2] = bulk_grow(r->bulk, 0, (size_t)below * (size_t)r->n + 1, sizeof *carried);
	double(*corner)[ENDS][2] = bulk_grow(r->bulk, 0, (size_t)r->n + 1, sizeof *corner), mm_px = track_px_per_mm(clip, clip->cam_from_head, s);
	for (long f = 0; f < r->n; f++) {
		struct eye_state *state = &r->eyes.state[f][side];
		struct line mesh[LIDS];
		bool known = project_rim(mesh, &rim, clip, r->pose[f]);
		for (int i = 0; i < below; i++)
			for (int k = 0; k < 2; k++)
				carried[f * below + i][k] = known ? mesh[LID_LOWER].p[i][k] : NAN;
		for (int c = 0; c < ENDS; c++)
			corner[f][c][0] = corner[f][c][1] = NAN;
		if (!isfinite(state->lid[0][0][0]) || !known)
			continue;
		for (int c = 0; c < ENDS; c++) {
			int end = c ? mesh[0].n - 1 : 0;
			for (int k = 0; k < 2; k++)
				corner[f][c][k] = mesh[0].p[end][k] + beside_moved(&skin[0], end, f)[k];
		}
		reshape(state, mesh, (const double(*)[2])corner[f]);
		for (int k = 0; k < LIDS; k++)
			draw_to_skin(state, k, &mesh[k], &skin[k], f, near_mm * mm_px, k == LID_LOWER && s->margin_seen[side] ? far_mm * mm_px : INFINITY);
	}
	blink_lower_carry(r, side, below, (const double(*)[2])carried);
	blink_upper_carry(r, side, corner, below, (const double(*)[2])carried, near_mm * mm_px);
	bulk_free(r->bulk, corner);
	bulk_free(r->bulk, carried);
	for (int k = 0; k < LIDS; k++)
		beside_free(&skin[k]);
}

void track_corners(struct track_result *r, const struct track_clip *clip, const struct track_subject *s, const struct track_points *points)
{
	for (int e = 0; e < SIDES && r->has_eyes && points->n; e++)
		if (s->margin[e].open && r->eyes.globe[e].seen)
			eye(r, e, clip, s, points);
}
