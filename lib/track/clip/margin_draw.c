#include "track/clip/margin_draw.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

/* Seconds over which what the evidence adds is averaged, and that of the frames between those looked at, whichever is longer: the margins' own motion is followed without it. */
static const double steady_s = 0.025, between = 0.6;
static const double few = 0.1;            // weight of the frames about one that counts as full
static const double reach = 0.4;          // of the iris' radius: how far from a margin its edge is looked for
static const double carried = 0.4;        // of the distance between the corners: a corner takes the margins along up to there
/* Shares of a margin's length in which the evidence's standard deviation falls from that of its inner and its outer end to the middle's; in which `ends_beyond` does. */
static const double fades[2] = { 0.25, 0.2 }, beyond_fades = 0.1;

/* Of one eye. */
struct margins {
	struct track_result *r;
	int side, every;
	long n;
	const struct margin_seen (*seen)[SIDES];
	const struct track_conf *conf;
	double sigma;                         // frames, of the average over time
	double (*x)[LID_POINTS_MAX], (*w)[LID_POINTS_MAX];  // [n] what is added, of the radius, and its weight
};

static bool known(const struct margins *m, long f)
{
	return isfinite(m->r->eyes.state[f][m->side].lid[LID_UPPER][0][0]);
}

static const struct margin_seen *seen_at(const struct margins *m, long f)
{
	const struct margin_seen *s = f % m->every ? 0 : &m->seen[f / m->every][m->side];
	return s && s->known && known(m, f) ? s : 0;
}

/* The radius of the iris in the frame or the last that was looked at, px. */
static double radius_at(const struct margins *m, long f)
{
	long g = f / m->every;
	while (g > 0 && !m->seen[g][m->side].known)
		g--;
	return m->seen[g][m->side].known ? (double)m->seen[g][m->side].radius : 0;
}

/* The mean of place i over the frames about one, weighted; the less the fewer of them tell. */
static double about(const struct margins *m, long f, int i)
{
	const long far = (long)ceil(3 * m->sigma), from = f < far ? 0 : f - far, to = f + far < m->n ? f + far : m->n - 1;
	double sum = 0, weight = 0, all = 0;
	for (long g = from; g <= to; g++) {
		const double near = exp(-0.5 * pow((double)(g - f) / m->sigma, 2));
		all += g % m->every ? 0 : near;
		sum += near * m->w[g][i] * m->x[g][i];
		weight += near * m->w[g][i];
	}
	return weight > 0 && all > 0 ? sum / weight * fmin(1, weight / all / few) : 0;
}

static double agrees(double off, const struct margins *m)
{
	return 1 / (1 + pow(off / m->conf->canthi.most, 4));
}

/* How much the evidence counts beside what was followed: by their variances. sigma: of the evidence, of the radius. px */
static double share(double sigma, double radius, const struct margins *m)
{
	const double told = sigma * radius, found = m->conf->lids.found_px;
	return found * found / (found * found + told * told);
}

/* Moves both margins' ends at corner c to where the evidence has it, and the rest the less the further it is from there. */
static void corner(struct margins *m, int c)
{
	const double *told = m->conf->lids.corner_sigma + 2 * c, *beyond = m->conf->canthi.beyond + 2 * c, out = c ? 1 : -1;
	double(*way)[2][2] = mem_new((size_t)m->n + 1, sizeof *way), *wide = mem_new((size_t)m->n + 1, sizeof *wide);
	for (long f = 0; f < m->n; f++) {
		const struct eye_state *state = &m->r->eyes.state[f][m->side];
		const struct margin_seen *s = seen_at(m, f);
		const int last = state->lid_points - 1;
		double off[2] = { 0 };
		for (int k = 0; k < 2; k++)
			m->x[f][k] = m->w[f][k] = 0;
		if (!known(m, f))
			continue;
		const double *a = state->lid[LID_UPPER][0], *b = state->lid[LID_UPPER][last], *at = c ? b : a;
		wide[f] = fmax(1e-9, hypot(b[0] - a[0], b[1] - a[1]));
		for (int k = 0; k < 2; k++)
			way[f][0][k] = out * (b[k] - a[k]) / wide[f];
		// downwards: at right angles to the line between the corners
		const double right = b[0] > a[0] ? 1 : -1;
		way[f][1][0] = -right * (b[1] - a[1]) / wide[f];
		way[f][1][1] = right * (b[0] - a[0]) / wide[f];
		if (!s || !s->ends)
			continue;
		for (int k = 0; k < 2; k++)
			off[k] = beyond[k] + (((double)s->corner[c][0] - at[0]) * way[f][k][0] + ((double)s->corner[c][1] - at[1]) * way[f][k][1]) / (double)s->radius;
		for (int k = 0; k < 2; k++) {
			m->x[f][k] = off[k];
			m->w[f][k] = agrees(hypot(off[0], off[1]), m);
		}
	}
	for (long f = 0; f < m->n; f++) {
		struct eye_state *state = &m->r->eyes.state[f][m->side];
		if (!known(m, f))
			continue;
		double move[2] = { 0 };
		for (int k = 0; k < 2; k++) {
			const double radius = radius_at(m, f), by = radius * share(told[k], radius, m) * about(m, f, k);
			for (int i = 0; i < 2; i++)
				move[i] += by * way[f][k][i];
		}
		for (int q = 0; q < LIDS; q++) {
			const double *end = state->lid[q][c ? state->lid_points - 1 : 0], from[2] = { end[0], end[1] };
			for (int i = 0; i < state->lid_points; i++) {
				double *p = state->lid[q][i];
				const double left = fmax(0, 1 - hypot(p[0] - from[0], p[1] - from[1]) / (carried * wide[f]));
				for (int k = 0; k < 2; k++)
					p[k] += left * left * move[k];
			}
		}
	}
	free(way);
	free(wide);
}

/* Unit vector out of the opening at point i of a margin. */
static void outward(double out[2], const struct eye_state *state, int lid, int i)
{
	const double(*p)[2] = state->lid[lid], *a = p[i ? i - 1 : 0], *b = p[i + 1 < state->lid_points ? i + 1 : i];
	const double right = p[state->lid_points - 1][0] > p[0][0] ? 1 : -1, side = lid == LID_LOWER ? right : -right, length = fmax(1e-9, hypot(b[0] - a[0], b[1] - a[1]));
	out[0] = -side * (b[1] - a[1]) / length;
	out[1] = side * (b[0] - a[0]) / length;
}

/* From the middle's value to those of the two ends, within `fade` of them. */
static double towards(const double ends[2], double middle, double u, const double fade[2])
{
	return middle + (ends[0] - middle) * fmax(0, 1 - u / fade[0]) + (ends[1] - middle) * fmax(0, 1 - (1 - u) / fade[1]);
}

/* Each place as it and its neighbours tell. */
static void even(double x[LID_POINTS_MAX], double w[LID_POINTS_MAX], int n)
{
	double sum[LID_POINTS_MAX], weight[LID_POINTS_MAX];
	for (int i = 0; i < n; i++) {
		const int a = i ? i - 1 : 0, b = i + 1 < n ? i + 1 : i;
		weight[i] = 0.25 * (w[a] + 2 * w[i] + w[b]);
		sum[i] = 0.25 * (w[a] * x[a] + 2 * w[i] * x[i] + w[b] * x[b]);
	}
	for (int i = 0; i < n; i++) {
		x[i] = weight[i] > 0 ? sum[i] / weight[i] : 0;
		w[i] = weight[i];
	}
}

/* Moves the places of a margin across it, each by how well evidence and margin are known there. */
static void margin(struct margins *m, int lid, double (*to)[LID_POINTS_MAX][2])
{
	const struct track_conf *c = m->conf;
	const double middle = c->canthi.outline_sigma, all[2] = { beyond_fades, beyond_fades };
	for (long f = 0; f < m->n; f++) {
		const struct margin_seen *s = seen_at(m, f);
		const struct eye_state *state = &m->r->eyes.state[f][m->side];
		memset(m->x[f], 0, sizeof m->x[f]);
		memset(m->w[f], 0, sizeof m->w[f]);
		for (int i = 0; s && i < state->lid_points; i++) {
			double out[2];
			const double u = (double)i / (state->lid_points - 1), radius = (double)s->radius, sigma = towards(c->lids.ends_sigma, middle, u, fades);
			outward(out, state, lid, i);
			const double edge = margin_seen_edge(s, state->lid[lid][i], out, reach * radius);
			if (isnan(edge))
				continue;
			m->x[f][i] = edge / radius + towards(c->lids.ends_beyond, c->canthi.outline_beyond, u, all);
			m->w[f][i] = agrees(m->x[f][i], m) * pow(middle / sigma, 2);
		}
		even(m->x[f], m->w[f], state->lid_points);
	}
	for (long f = 0; f < m->n; f++) {
		const struct eye_state *state = &m->r->eyes.state[f][m->side];
		for (int i = 0; known(m, f) && i < state->lid_points; i++) {
			double out[2];
			const double sigma = towards(c->lids.ends_sigma, middle, (double)i / (state->lid_points - 1), fades);
			const double radius = radius_at(m, f), by = radius * share(sigma, radius, m) * about(m, f, i);
			outward(out, state, lid, i);
			for (int k = 0; k < 2; k++)
				to[f][i][k] = state->lid[lid][i][k] + by * out[k];
		}
	}
	for (long f = 0; f < m->n; f++)
		if (known(m, f))
			memcpy(m->r->eyes.state[f][m->side].lid[lid], to[f], sizeof *to);
}

/* Both margins end in one corner. */
static void join(struct margins *m)
{
	for (long f = 0; f < m->n; f++)
		for (int c = 0; c < 2 && known(m, f) && radius_at(m, f) > 0; c++) {
			struct eye_state *state = &m->r->eyes.state[f][m->side];
			const int i = c ? state->lid_points - 1 : 0;
			for (int k = 0; k < 2; k++)
				state->lid[LID_UPPER][i][k] = state->lid[LID_LOWER][i][k] = 0.5 * (state->lid[LID_UPPER][i][k] + state->lid[LID_LOWER][i][k]);
		}
}

void margin_draw(struct track_result *r, const struct margin_seen (*seen)[SIDES], double fps, const struct track_conf *conf)
{
	const int every = conf->lids.every;
	struct margins m = { .r = r, .every = every, .n = r->n, .seen = seen, .conf = conf, .sigma = fmax(steady_s * fps, between * every) };
	double(*to)[LID_POINTS_MAX][2] = bulk_new(r->bulk, (size_t)r->n + 1, sizeof *to);
	m.x = bulk_new(r->bulk, (size_t)r->n + 1, sizeof *m.x);
	m.w = bulk_new(r->bulk, (size_t)r->n + 1, sizeof *m.w);
	for (m.side = 0; m.side < SIDES; m.side++) {
		corner(&m, 0);
		corner(&m, 1);
		margin(&m, LID_UPPER, to);
		margin(&m, LID_LOWER, to);
		join(&m);
	}
	bulk_free(r->bulk, to);
	bulk_free(r->bulk, m.x);
	bulk_free(r->bulk, m.w);
}
