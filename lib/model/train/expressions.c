/* What lids do with expressions (model/express.h): apertures of the frames in which an expression is on, beyond the baseline at their gaze, regressed on the strengths. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/regress.h"
#include "math/stats.h"
#include "model/train/impl.h"

enum { STEPS = 20, ROUNDS = 8, BLOCKS = 8, SHOWN_FRAMES = 3 };
static const double shown = 0.5;      // of an expression's strength: in so many frames it has to be, or the clip does not tell
static const double shut = 0.4;       // of the usual opening: lids that are closer together than the expression has them by so much, blink
static const double flank = 3;        // standard deviations: neighbours of such a frame that are closer by so much are its flanks
static const double least = 0.003;    // of an aperture's range: a standard deviation of lids is no smaller
static const double near_s = 0.1;     // frames further apart are no neighbours

/* The frames in which any expression is on, of one eye. */
struct on {
	int n, q;         // frames; expressions
	double *x;        // [n][q] strengths
	double *y[2];     // [n] controls of the upper and the lower lid, beyond the baseline
	double *time, *gaze;  // [n] s, [n][2] degrees
	bool *blinks;     // [n]
	double *w, *r[2]; // [n] weights; residuals
	double *b[2];     // [q] slopes
	double px[2], usual;
};

static void on_alloc(struct on *o, size_t room, int q)
{
	*o = (struct on){ .q = q, .x = mem_array(room * (size_t)q + 1, sizeof *o->x), .time = mem_array(room, sizeof *o->time), .gaze = mem_array(2 * room, sizeof *o->gaze),
		              .blinks = mem_new(room, sizeof *o->blinks), .w = mem_array(room, sizeof *o->w) };
	for (int lid = 0; lid < 2; lid++) {
		o->y[lid] = mem_array(room, sizeof *o->y[lid]);
		o->r[lid] = mem_array(room, sizeof *o->r[lid]);
		o->b[lid] = mem_new((size_t)q + 1, sizeof *o->b[lid]);
	}
}

static void on_free(struct on *o)
{
	free(o->x);
	free(o->time);
	free(o->gaze);
	free(o->blinks);
	free(o->w);
	for (int lid = 0; lid < 2; lid++) {
		free(o->y[lid]);
		free(o->r[lid]);
		free(o->b[lid]);
	}
}

static bool is_on(const struct skin_model *m, const double *g)
{
	for (int a = SKIN_EYE_INPUTS; a < m->n_inputs; a++)
		if (g[a] > TRAIN_ON)
			return true;
	return false;
}

/* Takes at most as many frames as a sample has, spread evenly. Where lids are measured, but the gaze behind them is not, it is as it was. */
static void take(struct on *o, const struct train *t, int eye)
{
	const struct skin_model *m = t->model;
	double *controls = mem_new((size_t)m->n_inputs, sizeof *controls), gaze[2] = { NAN, NAN }, px[EXPRESS_LIDS];
	long many = 0;
	for (long i = 0; i < t->clip->n; i++)
		many += is_on(m, t->g + i * m->n_inputs);
	const long step = 1 + many / (t->conf->sample + 1);
	on_alloc(o, (size_t)(many / step + 2), m->n_au);
	o->usual = train_usual_opening(t, eye);
	skin_model_range(px, m);
	memcpy(o->px, px + 2 * eye, sizeof o->px);
	many = 0;
	for (long i = 0; i < t->clip->n; i++) {
		const double *g = t->g + i * m->n_inputs, *measured = t->clip->g + i * m->n_inputs;
		double usual[2];
		for (int k = 0; k < 2; k++)
			gaze[k] = isnan(g[5 * eye + k]) ? gaze[k] : g[5 * eye + k];
		if (!is_on(m, g) || many++ % step || isnan(measured[5 * eye + 3] + measured[5 * eye + 4] + gaze[0] + gaze[1]))
			continue;
		skin_model_controls(controls, m, measured);
		skin_model_baseline(usual, m, eye, 1, gaze[0], gaze[1]);
		memcpy(o->x + (size_t)o->n * (size_t)o->q, g + SKIN_EYE_INPUTS, (size_t)o->q * sizeof *o->x);
		memcpy(o->gaze + 2L * o->n, gaze, sizeof gaze);
		o->time[o->n] = t->clip->time[i];
		for (int lid = 0; lid < 2; lid++)
			o->y[lid][o->n] = controls[5 * eye + 3 + lid] - usual[lid];
		o->n++;
	}
	free(controls);
}

/* An expression that hardly any of these frames shows is none. */
static bool leave_unshown(struct on *o, int a)
{
	int n = 0;
	for (int i = 0; i < o->n; i++)
		n += o->x[i * o->q + a] >= shown;
	for (int i = 0; i < o->n && n < SHOWN_FRAMES; i++)
		o->x[i * o->q + a] = 0;
	return n >= SHOWN_FRAMES;
}

/* Slopes b[q] through 0 of one lid; of the frames that show expression a, those numbered from .. to - 1 are left out (a < 0: none). */
static void solve(double *b, const struct on *o, int lid, int a, int from, int to)
{
	int q = o->q;
	double *G = mem_new((size_t)(q * q) + 1, sizeof *G), *z = mem_new((size_t)q + 1, sizeof *z), weight = 0;
	for (int i = 0, at = -1; i < o->n; i++) {
		const double *x = o->x + i * q;
		const bool shows = a >= 0 && x[a] > TRAIN_ON && o->w[i] > 0;
		at += shows;
		if (shows && at >= from && at < to)
			continue;
		weight += o->w[i];
		for (int j = 0; j < q && o->w[i] > 0; j++) {
			z[j] += o->w[i] * x[j] * o->y[lid][i];
			for (int c = 0; c < q; c++)
				G[j * q + c] += o->w[i] * x[j] * x[c];
		}
	}
	if (weight > 0)
		regress(b, q, 1, G, z, weight, 0, 0);
	else
		memset(b, 0, (size_t)q * sizeof *b);
	free(G);
	free(z);
}

/* Residuals of a lid into o->r; its standard deviation by the median, of frames that do not blink. */
static double spread(struct on *o, int lid)
{
	double *size = mem_array((size_t)o->n + 1, sizeof *size);
	int n = 0;
	for (int i = 0; i < o->n; i++) {
		o->r[lid][i] = o->y[lid][i];
		for (int j = 0; j < o->q; j++)
			o->r[lid][i] -= o->b[lid][j] * o->x[i * o->q + j];
		if (!o->blinks[i])
			size[n++] = fabs(o->r[lid][i]);
	}
	const double sigma = n ? 1.4826 * stats_median(n, size) : 0;
	free(size);
	return fmax(sigma, least);
}

/* Iteratively reweighted least squares, Huber's weights (1.345 sigma), the same for both lids of a frame: that of the one that is further off. sigma: out. */
static void fit(struct on *o, double sigma[2])
{
	for (int i = 0; i < o->n; i++)
		o->w[i] = !o->blinks[i];
	for (int step = 0; step < STEPS; step++) {
		for (int lid = 0; lid < 2; lid++) {
			solve(o->b[lid], o, lid, -1, 0, 0);
			sigma[lid] = spread(o, lid);
		}
		for (int i = 0; i < o->n; i++) {
			const double off = fmax(fabs(o->r[0][i]) / sigma[0], fabs(o->r[1][i]) / sigma[1]);
			o->w[i] = o->blinks[i] ? 0 : off > 1.345 ? 1.345 / off : 1;
		}
	}
}

/* Opening of a frame beyond what gaze and expressions explain, px. */
static double opened(const struct on *o, int i)
{
	return o->px[0] * o->r[0][i] + o->px[1] * o->r[1][i];
}

/* Marks frames that blink, and their flanks either way, by the present residuals; whether they are others than before. */
static bool find_blinks(struct on *o, const double sigma[2])
{
	const double limit = -flank * hypot(o->px[0] * sigma[0], o->px[1] * sigma[1]);
	bool changed = false, *now = mem_new((size_t)o->n + 1, sizeof *now);
	for (int i = 0; i < o->n; i++)
		now[i] = opened(o, i) < -shut * o->usual;
	for (int i = 1; i < o->n; i++)
		now[i] = now[i] || (now[i - 1] && o->time[i] - o->time[i - 1] < near_s && opened(o, i) < limit);
	for (int i = o->n - 2; i >= 0; i--)
		now[i] = now[i] || (now[i + 1] && o->time[i + 1] - o->time[i] < near_s && opened(o, i) < limit);
	for (int i = 0; i < o->n; i++) {
		changed = changed || now[i] != o->blinks[i];
		o->blinks[i] = now[i];
	}
	free(now);
	return changed;
}

/* Standard error of an expression's effect on one lid: the jackknife over eighths of the frames that show it, and the baseline's at their gaze. A clip shows an
 * expression once or twice: how it differs from one time to the next is not in it. */
static double sigma_of(const struct on *o, const struct skin_model *m, int eye, int lid, int a)
{
	double *b = mem_new((size_t)o->q + 1, sizeof *b), sum = 0, squares = 0, gaze[2] = { 0 }, weight = 0;
	int n = 0;
	for (int i = 0; i < o->n; i++) {
		const double w = o->w[i] > 0 && o->x[i * o->q + a] > TRAIN_ON ? o->w[i] * o->x[i * o->q + a] : 0;
		n += w > 0;
		weight += w;
		for (int k = 0; k < 2; k++)
			gaze[k] += w * o->gaze[2 * i + k];
	}
	const int blocks = n < BLOCKS ? n : BLOCKS;
	for (int k = 0; k < blocks; k++) {
		solve(b, o, lid, a, n * k / blocks, n * (k + 1) / blocks);
		sum += b[a];
		squares += b[a] * b[a];
	}
	free(b);
	if (blocks < 2)
		return NAN;
	const double *base = m->baseline_sigma[eye][lid], own = fmax(0, squares - sum * sum / blocks) * (blocks - 1) / blocks;
	return sqrt(own + pow(base[0] * gaze[0] / weight, 2) + pow(base[1] * gaze[1] / weight, 2) + base[2] * base[2]);
}

static void of_eye(struct train *t, int eye)
{
	struct skin_model *m = t->model;
	struct on o;
	double sigma[2];
	take(&o, t, eye);
	bool *told = mem_new((size_t)o.q + 1, sizeof *told), any = false;
	for (int a = 0; a < o.q; a++) {
		told[a] = leave_unshown(&o, a);
		any = any || told[a];
	}
	for (int round = 0; any && round < ROUNDS; round++) {
		fit(&o, sigma);
		if (!find_blinks(&o, sigma))
			break;
	}
	for (int a = 0; a < o.q; a++)
		for (int lid = 0; lid < 2 && told[a]; lid++) {
			m->expression[a][2 * eye + lid] = o.b[lid][a];
			m->expression_sigma[a][2 * eye + lid] = sigma_of(&o, m, eye, lid, a);
		}
	free(told);
	on_free(&o);
}

void train_expressions(struct train *t)
{
	struct skin_model *m = t->model;
	for (int i = 0; i < EXPRESS_LIDS * m->n_au; i++)
		m->expression_sigma[i / EXPRESS_LIDS][i % EXPRESS_LIDS] = NAN;
	for (int e = 0; e < 2 && m->n_au; e++)
		if (t->eye[e])
			of_eye(t, e);
}
