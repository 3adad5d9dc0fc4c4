#include "motion/animate.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "model/gaze_table.h"

enum { MOST_FRAMES = 1 << 22 };

struct run {
	const struct skin_model *model;
	const struct script *gaze, *keys;
	const struct animate_places *places;
	const struct animate_conf *conf;
	struct animation *out;
	double duration;
};

void animation_free(struct animation *a)
{
	free(a->g);
	free(a->controls);
	free(a->closure);
	free(a->head);
	free(a->blinks);
	free(a->saccades);
	*a = (struct animation){ 0 };
}

/* Direction, degrees, of a place of the scene (share of its width and height). aspect: height over width. */
static void direction(double out[2], const double at[2], double width_deg, double aspect)
{
	// The scene is a plane before the person, who sees its right side on their right: -x of the head.
	double half = tan(0.5 * width_deg * M_PI / 180), x = -(2 * at[0] - 1) * half, y = -(2 * at[1] - 1) * half * aspect;
	out[0] = atan(x) * 180 / M_PI;
	out[1] = atan2(y, hypot(x, 1)) * 180 / M_PI;
}

/* Index of the last of n times at or before t; 0 before all. */
static long before(long n, const double *time, double t)
{
	long low = 0, high = n;
	while (high - low > 1) {
		long mid = (low + high) / 2;
		*(time[mid] <= t ? &low : &high) = mid;
	}
	return low;
}

/* A column of the recording at t: linear between the rows that have a value; NAN without any. */
static double recorded(const struct script *s, int stride, const double *x, int column, double t)
{
	long a = before(s->n, s->time, t), b = a + 1;
	while (a >= 0 && isnan(x[a * stride + column]))
		a--;
	while (b < s->n && isnan(x[b * stride + column]))
		b++;
	if (a < 0 && b >= s->n)
		return NAN;
	if (a < 0 || b >= s->n)
		return x[(a < 0 ? b : a) * stride + column];
	double share = fmin(1, fmax(0, (t - s->time[a]) / (s->time[b] - s->time[a])));
	return x[a * stride + column] + share * (x[b * stride + column] - x[a * stride + column]);
}

/* Target and head at t, for gaze_sim. */
static void source(void *ctx, double t, struct gaze_input *in)
{
	const struct run *r = ctx;
	const struct animate_conf *c = r->conf;
	*in = (struct gaze_input){ .distance = INFINITY };
	if (r->places) {
		long i = before(r->places->n, r->places->t, t);
		if (r->places->n)
			direction(in->target, r->places->at[i], c->scene_deg, r->places->aspect);
		in->distance = c->scene_distance;
	} else if (r->gaze && r->gaze->kind == SCRIPT_SCREEN) {
		double at[2] = { recorded(r->gaze, 2, r->gaze->screen, 0, t) / c->screen[0],
			             recorded(r->gaze, 2, r->gaze->screen, 1, t) / c->screen[1] };
		if (!isnan(at[0]) && !isnan(at[1]))
			direction(in->target, at, c->scene_deg, c->screen[1] / c->screen[0]);
		in->distance = c->scene_distance;
	} else if (r->keys)
		script_target(in->target, &in->distance, r->keys, t);
	if (r->keys) {
		in->head[0] = script_smooth(&r->keys->key[KEY_HEAD_H], t, 0);
		in->head[1] = script_smooth(&r->keys->key[KEY_HEAD_V], t, 0);
	}
}

static void add_blink(struct animation *a, struct blink blink)
{
	a->blinks = mem_grow(a->blinks, (size_t)a->n_blinks + 1, sizeof *a->blinks);
	int at = a->n_blinks++;
	for (; at > 0 && a->blinks[at - 1].start > blink.start; at--)
		a->blinks[at] = a->blinks[at - 1];
	a->blinks[at] = blink;
}

static bool near_blink(const struct animation *a, double start, double end)
{
	for (int i = 0; i < a->n_blinks; i++)
		if (a->blinks[i].start < end && blink_end(&a->blinks[i]) > start)
			return true;
	return false;
}

/* Blinks of keys first, then those of large saccades, then spontaneous ones that overlap no other. */
static void plan_blinks(struct run *r)
{
	const struct animate_conf *c = r->conf;
	struct animation *a = r->out;
	struct rng rng = { c->seed * 2 + 1 };
	const struct script_track *keyed = r->keys ? &r->keys->key[KEY_BLINK] : 0;
	for (int i = 0; keyed && i < keyed->n; i++)
		if (keyed->v[i] > 0)
			add_blink(a, blink_make(keyed->t[i], keyed->v[i] * c->blink.full, &c->blink));
	for (int i = 0; i < a->n_saccades && c->gaze_blink > 0; i++) {
		struct blink b = blink_make(a->saccades[i].start, blink_amplitude(&rng, &c->blink), &c->blink);
		if (a->saccades[i].amplitude >= c->gaze_blink && !near_blink(a, b.start, blink_end(&b)))
			add_blink(a, b);
	}
	for (double t = blink_interval(&rng, &c->blink) * rng_uniform(&rng); c->blinks && t < r->duration;) {
		struct blink b = blink_make(t, blink_amplitude(&rng, &c->blink), &c->blink);
		if (!near_blink(a, b.start, blink_end(&b)))
			add_blink(a, b);
		t = fmax(blink_end(&b), t + blink_interval(&rng, &c->blink));
	}
}

/* Deepest closure at t; turned: share of the blinks' own rotation of the eyes. */
static double closure_at(const struct animation *a, double t, double *turned)
{
	double closure = 0;
	*turned = 0;
	for (int i = 0; i < a->n_blinks && a->blinks[i].start <= t; i++)
		if (t < blink_end(&a->blinks[i])) {
			closure = fmax(closure, blink_closure(&a->blinks[i], t));
			*turned = fmax(*turned, a->blinks[i].closure * blink_eye(&a->blinks[i], t));
		}
	return closure;
}

/* Angles of both eyes at every frame, by simulation or as recorded. */
static void move_eyes(struct run *r)
{
	struct animation *a = r->out;
	struct gaze_conf gaze = r->conf->gaze;
	bool replay = r->gaze && r->gaze->kind == SCRIPT_RECORDED, keyed = !r->gaze && !r->places;
	if (keyed)
		gaze.latency[0] = r->conf->key_latency, gaze.latency[1] = 0;
	struct gaze_sim *sim = gaze_sim_new(&gaze, source, r, r->conf->seed);
	for (long i = 0; i < a->n; i++) {
		double t = (double)i / a->fps, *g = a->g + i * a->n_inputs;
		struct gaze_output eyes = { 0 };
		if (!replay) {
			gaze_sim_at(sim, t, &eyes);
			for (int e = 0; e < 2; e++)
				memcpy(g + 5 * e, eyes.eye[e], 3 * sizeof *g);
		}
		for (int k = 0; k < SKIN_EYE_INPUTS && replay; k++)
			g[k] = recorded(r->gaze, a->n_inputs, r->gaze->g, k, t);
		for (int e = 0; e < 2 && replay; e++)  // an eye that was not recorded moves with the other
			for (int k = 0; k < 3; k++) {
				double other = g[5 * (1 - e) + k];
				g[5 * e + k] = !isnan(g[5 * e + k]) ? g[5 * e + k] : k == 2 ? NAN : other;
			}
		for (int e = 0; e < 2; e++)
			if (replay && isnan(g[5 * e + 2]))
				g[5 * e + 2] = listing_torsion(g[5 * e], g[5 * e + 1]);
	}
	const struct gaze_saccade *done = gaze_sim_saccades(sim, &a->n_saccades);
	a->saccades = mem_new((size_t)a->n_saccades + 1, sizeof *a->saccades);
	if (a->n_saccades)
		memcpy(a->saccades, done, (size_t)a->n_saccades * sizeof *done);
	gaze_sim_free(sim);
}

/* Clamps an aperture to the clip's range, extended by the share `beyond` on either side. */
static double within(const struct skin_model *m, int input, double g, double beyond)
{
	double pad = beyond * (m->high[input] - m->low[input]);
	return isnan(pad) ? g : fmin(m->high[input] + pad, fmax(m->low[input] - pad, g));
}

/* Expressions, apertures (eq. 3.11 with c from keys and blinks, and what lids do with the expressions; as recorded, where they are) and the rotation of the eyes in a blink. */
static void move_lids(struct run *r)
{
	struct animation *a = r->out;
	const struct skin_model *m = r->model;
	bool replay = r->gaze && r->gaze->kind == SCRIPT_RECORDED, apertures = replay && r->gaze->has_apertures;
	double px[EXPRESS_LIDS];
	skin_model_range(px, m);
	for (long i = 0; i < a->n; i++) {
		double t = (double)i / a->fps, *g = a->g + i * a->n_inputs, *c = a->controls + i * a->n_inputs, turned;
		double open = r->keys ? script_smooth(&r->keys->key[KEY_OPENNESS], t, 1) : 1, own[SKIN_EYE_INPUTS];
		memcpy(own, g, sizeof own);
		a->closure[i] = closure_at(a, t, &turned);
		for (int k = 0; k < m->n_au; k++) {
			double au = replay ? recorded(r->gaze, a->n_inputs, r->gaze->g, SKIN_EYE_INPUTS + k, t) : 0;
			g[SKIN_EYE_INPUTS + k] = r->keys ? script_smooth(&r->keys->au[k], t, isnan(au) ? 0 : au) : isnan(au) ? 0 : au;
		}
		for (int e = 0; e < 2; e++) {
			double lids[2], nasal = e ? 1 : -1;  // the nose is to the right of the left eye
			double wink = r->keys ? script_smooth(&r->keys->key[e ? KEY_WINK_RIGHT : KEY_WINK_LEFT], t, 0) : 0, still_open = (1 - a->closure[i]) * (1 - wink);
			skin_model_baseline(lids, m, e, open * still_open, g[5 * e], g[5 * e + 1]);
			express_eye(lids, e, m->n_au, g + SKIN_EYE_INPUTS, (const double(*)[EXPRESS_LIDS])m->expression, px, open * still_open);
			for (int k = 0; k < 2; k++) {
				int at = 5 * e + 3 + k;
				g[at] = within(m, at, m->closed[at] + (m->open[at] - m->closed[at]) * lids[k], r->conf->beyond);
				if (apertures && !isnan(own[at]))
					g[at] = m->closed[at] + (own[at] - m->closed[at]) * still_open;
			}
			g[5 * e] += nasal * turned * r->conf->blink.eye_deg / M_SQRT2;
			g[5 * e + 1] -= turned * r->conf->blink.eye_deg / M_SQRT2;
		}
		skin_model_controls(c, m, g);
		a->head[2 * i] = r->keys ? script_smooth(&r->keys->key[KEY_HEAD_H], t, 0) : 0;
		a->head[2 * i + 1] = r->keys ? script_smooth(&r->keys->key[KEY_HEAD_V], t, 0) : 0;
	}
}

bool animate_run(struct animation *out, const struct skin_model *m, const struct script *gaze, const struct script *keys,
                 const struct animate_places *places, const struct animate_conf *conf, struct err *err)
{
	struct run r = { m, gaze, keys, places, conf, out, conf->duration };
	*out = (struct animation){ .n_inputs = m->n_inputs, .fps = conf->fps };
	if (isnan(r.duration))
		r.duration = fmax(fmax(gaze ? gaze->last : 0, keys ? keys->last + conf->hold : 0), places ? places->duration : 0);
	double frames = floor(r.duration * conf->fps) + 1;
	if (frames > MOST_FRAMES)
		return err_set(err, "animate.duration_s: %.0f s at %g frames/s are %.0f frames: must be <= %d", r.duration, conf->fps, frames,
		               MOST_FRAMES);
	out->n = (long)frames;
	out->g = mem_new((size_t)out->n * (size_t)m->n_inputs, sizeof *out->g);
	out->controls = mem_new((size_t)out->n * (size_t)m->n_inputs, sizeof *out->controls);
	out->closure = mem_new((size_t)out->n, sizeof *out->closure);
	out->head = mem_new(2 * (size_t)out->n, sizeof *out->head);
	move_eyes(&r);
	if (!(gaze && gaze->kind == SCRIPT_RECORDED && gaze->has_apertures))
		plan_blinks(&r);
	else if (keys) {  // recorded lids blink by themselves; keyed blinks come on top
		struct animate_conf keyed = *conf;
		keyed.blinks = false;
		keyed.gaze_blink = 0;
		r.conf = &keyed;
		plan_blinks(&r);
		r.conf = conf;
	}
	move_lids(&r);
	return true;
}

bool animation_save(const char *path, const struct animation *a, struct err *err)
{
	static const char *const tail[] = { "a4", "a5", "a9", "a10", "closure", "head_horizontal_deg", "head_vertical_deg" };
	static const int apertures[4] = { 3, 4, 8, 9 };
	int n_au = a->n_inputs - SKIN_EYE_INPUTS, n = 2 + a->n_inputs + COUNT(tail);
	const char **names = mem_new((size_t)n, sizeof *names);
	char(*au)[24] = mem_new((size_t)n_au + 1, sizeof *au);
	double *row = mem_new((size_t)n, sizeof *row);
	names[0] = "frame";
	names[1] = "time_s";
	for (int i = 0; i < n_au; i++)
		snprintf(au[i], sizeof au[i], "au%d", i + 1);
	for (int i = 0; i < a->n_inputs; i++)
		names[2 + i] = i < SKIN_EYE_INPUTS ? gaze_columns[i] : au[i - SKIN_EYE_INPUTS];
	for (int i = 0; i < COUNT(tail); i++)
		names[2 + a->n_inputs + i] = tail[i];
	struct csv_table table = csv_table_new(n, names);
	for (long i = 0; i < a->n; i++) {
		double *to = row + 2 + a->n_inputs;
		row[0] = (double)i;
		row[1] = (double)i / a->fps;
		memcpy(row + 2, a->g + i * a->n_inputs, (size_t)a->n_inputs * sizeof *row);
		for (int k = 0; k < 4; k++)
			to[k] = a->controls[i * a->n_inputs + apertures[k]];
		to[4] = a->closure[i];
		memcpy(to + 5, a->head + 2 * i, 2 * sizeof *row);
		csv_add(&table, row);
	}
	bool ok = csv_save(path, &table, err);
	csv_table_free(&table);
	free(names);
	free(au);
	free(row);
	return ok;
}
