#include "track/clip/expressions.h"

#include <lapacke.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/stage.h"
#include "math/chol.h"

enum { EYE_INPUTS = 10, OTHER = 4, SAMPLE = 160, AU_MAX = 24, BASIS = AU_MAX + OTHER };

static const double noise_px = 0.3, shown_px = 0.7;  // of a point; least rms motion between neutral and peak

struct space {
	const struct track_result *r;
	int n, m;              // points; motions
	double *zero;          // [2 n] places of the points at rest
	double *weight;        // [n]
	double *motion[BASIS]; // [2 n] expressions, then others
};

/* Mean place of the points over frames f-1..f+1. */
static void places(double *out, const struct track_result *r, long f)
{
	long n = r->n_points, a = f > 0 ? f - 1 : f, b = f + 1 < r->n ? f + 1 : f;
	for (long i = 0; i < n; i++)
		for (int k = 0; k < 2; k++) {
			double sum = 0, w = 1e-9;
			for (long j = a; j <= b; j++) {
				double c = r->confidence[j * n + i] + 1e-6;
				sum += c * r->skin_model[j * n + i][k];
				w += c;
			}
			out[2 * i + k] = sum / w;
		}
}

static bool check(const struct track_result *r, const struct opt_each_list *list, struct err *err)
{
	if (list->n > AU_MAX)
		return err_set(err, "capture.conf: expression.*: %d expressions: at most %d", list->n, AU_MAX);
	for (int i = 0; i < list->n; i++)
		for (int k = 0; k < 2; k++) {
			double f = list->items[i].value[k];
			if (!(f >= 0 && f < (double)r->n && f == floor(f)))
				return err_set(err, "capture.conf: expression.%s = %s: must be two frames of the video, in [0, %ld]",
				               list->items[i].name, list->items[i].text, r->n - 1);
		}
	return true;
}

/* True when no expression rises, shows or fades in the frame. */
static bool plain(const struct opt_each_list *list, long f)
{
	for (int i = 0; i < list->n; i++) {
		double neutral = list->items[i].value[0], peak = list->items[i].value[1], far = 2 * fabs(peak - neutral);
		if (fabs(f - peak) <= far)
			return false;
	}
	return true;
}

/* From frames without expression: variance of each point (its weight) and the principal components of their motion. */
static void learn_rest(struct space *s, const struct opt_each_list *list)
{
	const struct track_result *r = s->r;
	int n = s->n, m = 0;
	long step = (r->n + SAMPLE - 1) / SAMPLE;
	double *d = mem_new((size_t)SAMPLE * 2 * (size_t)n + 1, sizeof *d), *gram = mem_new(SAMPLE * SAMPLE, sizeof *gram), *value = mem_new(SAMPLE, sizeof *value);
	for (long f = 0; f < r->n && m < SAMPLE; f += step)
		if (plain(list, f)) {
			for (int i = 0; i < 2 * n; i++)
				d[(long)m * 2 * n + i] = r->confidence[f * n + i / 2] > 0 ? r->skin_model[f * n + i / 2][i % 2] - s->zero[i] : 0;
			m++;
		}
	for (int i = 0; i < n; i++) {
		double sum = 0;
		for (int j = 0; j < m; j++)
			sum += pow(d[(long)j * 2 * n + 2 * i], 2) + pow(d[(long)j * 2 * n + 2 * i + 1], 2);
		s->weight[i] = 1 / (noise_px * noise_px + sum / fmax(1, m));
	}
	for (int a = 0; a < m; a++)
		for (int b = 0; b <= a; b++) {
			double sum = 0;
			for (int i = 0; i < 2 * n; i++)
				sum += s->weight[i / 2] * d[(long)a * 2 * n + i] * d[(long)b * 2 * n + i];
			gram[a * m + b] = gram[b * m + a] = sum;
		}
	if (m > OTHER && LAPACKE_dsyev(LAPACK_ROW_MAJOR, 'V', 'U', m, gram, m, value) == 0)
		for (int k = 0; k < OTHER; k++) {
			double *to = s->motion[s->m++] = mem_new(2 * (size_t)n + 1, sizeof *to);
			for (int a = 0; a < m; a++)
				for (int i = 0; i < 2 * n; i++)
					to[i] += gram[a * m + m - 1 - k] * d[(long)a * 2 * n + i];
		}
	free(d);
	free(gram);
	free(value);
}

/* Strengths of all motions in a frame by weighted least squares. */
static void strengths(double out[BASIS], const struct space *s, long f)
{
	double H[BASIS][BASIS] = { { 0 } };
	const struct track_result *r = s->r;
	memset(out, 0, BASIS * sizeof *out);
	for (int i = 0; i < s->n; i++) {
		double w = s->weight[i] * r->confidence[f * s->n + i];
		for (int k = 0; k < 2 && w > 0; k++) {
			double d = r->skin_model[f * s->n + i][k] - s->zero[2 * i + k];
			for (int a = 0; a < s->m; a++) {
				double wa = w * s->motion[a][2 * i + k];
				out[a] += wa * d;
				for (int b = 0; b <= a; b++)
					H[a][b] += wa * s->motion[b][2 * i + k];
			}
		}
	}
	for (int a = 0; a < s->m; a++)
		H[a][a] = H[a][a] * 1.001 + 1e-9;
	if (!chol_solve(s->m, BASIS, &H[0][0], out))
		memset(out, 0, BASIS * sizeof *out);
}

/* The motion of each expression; zero where the skin hardly moves. */
static void learn_shown(struct space *s, struct stage *stage, const struct opt_each_list *list)
{
	double *peak = mem_new(2 * (size_t)s->n + 1, sizeof *peak), *neutral = mem_new(2 * (size_t)s->n + 1, sizeof *neutral);
	for (int k = 0; k < list->n; k++) {
		places(neutral, s->r, (long)list->items[k].value[0]);
		places(peak, s->r, (long)list->items[k].value[1]);
		double *to = s->motion[s->m++] = mem_new(2 * (size_t)s->n + 1, sizeof *to), sum = 0;
		for (int i = 0; i < 2 * s->n; i++) {
			to[i] = peak[i] - neutral[i];
			s->zero[i] += neutral[i] / list->n;
			sum += to[i] * to[i];
		}
		if (sqrt(sum / s->n) < shown_px) {
			stage_skipped(stage, "expression.%s = %s: the skin hardly moves between these frames (%.1f px): it is left out; look for its peak",
			              list->items[k].name, list->items[k].text, sqrt(sum / s->n));
			memset(to, 0, 2 * (size_t)s->n * sizeof *to);
		}
	}
	free(peak);
	free(neutral);
}

bool track_expressions(struct track_result *r, struct stage *stage, const struct track_conf *conf, struct err *err)
{
	const struct opt_each_list *list = &conf->expression;
	if (!check(r, list, err))
		return false;
	if (!list->n)
		return true;
	struct space s = { .r = r, .n = r->n_points };
	s.zero = mem_new(2 * (size_t)s.n + 1, sizeof *s.zero);
	s.weight = mem_new((size_t)s.n + 1, sizeof *s.weight);
	learn_shown(&s, stage, list);
	learn_rest(&s, list);
	int width = EYE_INPUTS + r->n_au;
	for (long f = 0; f < r->n; f++) {
		double a[BASIS];
		strengths(a, &s, f);
		for (int k = 0; k < list->n; k++)
			r->g[f * width + EYE_INPUTS + k] = fmax(0, fmin(1, a[k]));
	}
	for (int k = 0; k < s.m; k++)
		free(s.motion[k]);
	free(s.zero);
	free(s.weight);
	return true;
}
