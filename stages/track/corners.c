/* The margins where they run into the corners of the eye. There the picture shows little: what is white goes over into what is wet and
 * red. The mesh knows how a corner is shaped, and the skin beside it how it moves. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "stages/track/line.h"

enum { ENDS = 2 };

/* Shares of the distance between the corners: what the mesh shapes at either end; how far skin tells of a corner. */
static const double shaped = 0.14, beside = 0.055;
/* How far skin is believed where it is near what is seen of either margin, and how near that is, mm: skin of the lower lid runs into
 * its margin; that of the upper hangs over it. */
static const double believed[LIDS] = { 0.4, 1 }, near_mm = 0.35;
// Of a full weight: less skin in sight does not tell.
static const double least_skin = 0.15;

/* The margin of the mesh, both lids from the inner corner to the outer, head frame. */
struct rim {
	int n[LIDS];
	double head[LIDS][OPENING_POINTS + 2][3];
};

/* The place of the outline after which a corner lies. */
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

/* How far the skin beside a place of the margin is from where the head alone would take it, less what it was at the reference: px, by
 * the points nearest to it. Returns their weight. */
static double skin_moved(double moved[2], const struct track_result *r, const struct track_points *points, const struct track_clip *clip, long frame,
                         const double head[3], double reach)
{
	double weight = 0;
	moved[0] = moved[1] = 0;
	for (int i = 0; i < points->n; i++) {
		const double *p = points->head[i];
		double d2 = (p[0] - head[0]) * (p[0] - head[0]) + (p[1] - head[1]) * (p[1] - head[1]) + (p[2] - head[2]) * (p[2] - head[2]), now[2], was[2];
		if (d2 > 9 * reach * reach)
			continue;
		long at = frame * r->n_points + i, at0 = clip->reference * r->n_points + i;
		double w = (double)r->confidence[at] * exp(-d2 / (reach * reach));
		if (!(w > 1e-6) || !head_project(now, &clip->camera, r->pose[frame], points->head[i])
		    || !head_project(was, &clip->camera, clip->cam_from_head, points->head[i]))
			continue;
		weight += w;
		for (int k = 0; k < 2; k++)
			moved[k] += w * ((double)r->skin[at][k] - now[k] - (double)r->skin[at0][k] + was[k]);
	}
	for (int k = 0; k < 2; k++)
		moved[k] /= fmax(weight, 1e-12);
	return weight;
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

/* The mesh's margin between a corner and the share u, mapped, in the order from inner to outer. */
static void add_end(struct line *out, const struct line *mesh, const double corners[ENDS][2], int end, double m[2][3])
{
	for (int i = 0; i < mesh->n; i++) {
		double u = line_along(mesh->p[i], corners[0], corners[1]), p[2];
		if (end ? u < 1 - shaped : u > shaped)
			continue;
		for (int k = 0; k < 2; k++)
			p[k] = m[k][0] * mesh->p[i][0] + m[k][1] * mesh->p[i][1] + m[k][2];
		line_add(out, p);
	}
}

/* Both margins of a frame, their ends as the mesh has them between the corners and where the margins are clear. */
static void reshape(struct eye_state *state, const struct line mesh[LIDS], const double corner[ENDS][2])
{
	double from[ENDS][2], map[ENDS][2][3];
	struct line found[LIDS], out[LIDS] = { 0 };
	for (int c = 0; c < ENDS; c++)
		memcpy(from[c], mesh[0].p[c ? mesh[0].n - 1 : 0], sizeof from[c]);
	for (int k = 0; k < LIDS; k++) {
		found[k].n = state->lid_points;
		memcpy(found[k].p, state->lid[k], (size_t)state->lid_points * sizeof *found[k].p);
	}
	for (int c = 0; c < ENDS; c++) {
		double a[3][2], b[3][2], u = c ? 1 - shaped : shaped;
		memcpy(a[0], from[c], sizeof a[0]);
		memcpy(b[0], corner[c], sizeof b[0]);
		for (int k = 0; k < LIDS; k++)
			if (!line_passes(a[1 + k], &mesh[k], u, from) || !line_passes(b[1 + k], &found[k], u, corner))
				return;
		if (!affine(map[c], a, b))
			return;
	}
	for (int k = 0; k < LIDS; k++) {
		add_end(&out[k], &mesh[k], from, 0, map[0]);
		for (int i = 0; i < found[k].n; i++) {
			double u = line_along(found[k].p[i], corner[0], corner[1]);
			if (u > shaped && u < 1 - shaped)
				line_add(&out[k], found[k].p[i]);
		}
		add_end(&out[k], &mesh[k], from, 1, map[1]);
		if (out[k].n < LIDS)
			return;
	}
	for (int k = 0; k < LIDS; k++)
		line_spread(state->lid[k], state->lid_points, &out[k]);
}

/* A margin drawn towards where the mesh's is carried by the skin beside it, as far as the two are not at odds. */
static void draw_to_skin(struct eye_state *state, int lid, const struct line *mesh, const double (*moved)[2], const double *weight, double near_px)
{
	struct line found = { .n = state->lid_points }, out = { .n = mesh->n };
	memcpy(found.p, state->lid[lid], (size_t)found.n * sizeof *found.p);
	for (int i = 0; i < mesh->n; i++) {
		double p[2] = { mesh->p[i][0] + moved[i][0], mesh->p[i][1] + moved[i][1] }, q[2];
		bool end = i == 0 || i == mesh->n - 1;
		memcpy(q, end ? found.p[i ? found.n - 1 : 0] : p, sizeof q);
		if (!end)
			line_nearest(q, &found, p);
		double off = hypot(p[0] - q[0], p[1] - q[1]) / near_px, share = end ? 0 : believed[lid] * fmin(1, weight[i]) / (1 + pow(off, 4));
		for (int k = 0; k < 2; k++)
			out.p[i][k] = q[k] + share * (p[k] - q[k]);
	}
	line_spread(state->lid[lid], state->lid_points, &out);
}

/* Where the skin beside a corner is not seen, it moves from where it was last to where it is next. */
static void fill(long n, double (*moved)[2], const bool *told)
{
	long last = -1;
	for (long f = 0; f <= n; f++) {
		if (f < n && !told[f])
			continue;
		for (long i = last + 1; i < f; i++)
			for (int k = 0; k < 2; k++) {
				double a = last < 0 ? (f < n ? moved[f][k] : 0) : moved[last][k], b = f < n ? moved[f][k] : a;
				moved[i][k] = a + (b - a) * (double)(i - last) / (double)(f - last);
			}
		last = f;
	}
}

void track_corners(struct track_result *r, const struct track_clip *clip, const struct track_subject *s, const struct track_points *points)
{
	for (int e = 0; e < SIDES && r->has_eyes && points->n; e++) {
		const struct eye_opening *o = &s->margin[e];
		struct rim rim;
		double(*moved)[2] = mem_array(ENDS * (size_t)r->n + 1, sizeof *moved), wide = 0;
		bool *told = mem_new((size_t)r->n + 1, sizeof *told);
		for (int k = 0; k < 3; k++)
			wide += pow(o->canthus[1][k] - o->canthus[0][k], 2);
		for (int c = 0; c < ENDS && o->open; c++) {
			for (long f = 0; f < r->n; f++)
				told[f] = skin_moved(moved[c * r->n + f], r, points, clip, f, o->canthus[c], beside * sqrt(wide)) > least_skin;
			fill(r->n, moved + c * r->n, told);
		}
		if (o->open)
			rim_of(&rim, o);
		for (long f = 0; f < r->n && o->open && r->eyes.globe[e].seen; f++) {
			struct eye_state *state = &r->eyes.state[f][e];
			struct line mesh[LIDS];
			double corner[ENDS][2];
			if (!isfinite(state->lid[0][0][0]) || !project_rim(mesh, &rim, clip, r->pose[f]))
				continue;
			for (int c = 0; c < ENDS; c++)
				for (int k = 0; k < 2; k++)
					corner[c][k] = mesh[0].p[c ? mesh[0].n - 1 : 0][k] + moved[c * r->n + f][k];
			reshape(state, mesh, corner);
			double near_px = near_mm * clip->camera.focal_px / clip->cam_from_head[2][3];
			for (int k = 0; k < LIDS; k++) {
				double by[OPENING_POINTS + 2][2], weight[OPENING_POINTS + 2];
				for (int i = 0; i < rim.n[k]; i++)
					weight[i] = skin_moved(by[i], r, points, clip, f, rim.head[k][i], beside * sqrt(wide)) / least_skin;
				draw_to_skin(state, k, &mesh[k], (const double(*)[2])by, weight, near_px);
			}
		}
		free(moved);
		free(told);
	}
}
