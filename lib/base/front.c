#include "base/front.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

/* Parses "0.012 mm, 0.05 s + 0.04 s/Mpx: scale = 0.5". */
static bool read_point(struct front_point *p, const struct conf_item *item, struct err *err)
{
	int end = 0;
	const char *dot = strchr(item->key, '.');
	*p = (struct front_point){ .line = item->line };
	const int n = sscanf(item->value, "%lf %7[^ ,:], %lf s + %lf s/Mpx: %n", &p->error, p->unit, &p->fixed_s, &p->mpx_s, &end);
	if (n == 4 && !end)
		sscanf(item->value, "%*f %*7[^ ,:], %*f s + %*f s/Mpx + %lf s/Mtexel: %n", &p->mtexel_s, &end);
	if (!dot || n != 4 || !end || !(p->error >= 0) || !(p->fixed_s >= 0) || !(p->mpx_s >= 0) || !(p->mtexel_s >= 0))
		return err_set(err, "%s:%d: %.60s = %.80s: must be \"STAGE.NAME = ERROR UNIT, S s + S s/Mpx + S s/Mtexel: key = value, ...\"", item->file,
		               item->line, item->key, item->value);
	p->stage = mem_printf("%.*s", (int)(dot - item->key), item->key);
	p->name = mem_str(dot + 1);
	p->settings = mem_str(item->value + end);
	return true;
}

/* Appends a continuation line, "unrefract.small.more = survey_size = 320", to the settings of the point before it. Returns false
 * where the line is no continuation. */
static bool read_more(struct front *front, const struct conf_item *item, struct err *err)
{
	const char *dot = strchr(item->key, '.'), *more = dot ? strstr(dot + 1, ".more") : 0;
	struct front_point *p = front->n ? &front->points[front->n - 1] : 0;
	if (!more)
		return false;
	char *of = mem_printf("%.*s", (int)(more - item->key), item->key), *name = mem_printf("%s.%s", p ? p->stage : "", p ? p->name : "");
	if (!p || strcmp(of, name)) {
		err_set(err, "%s:%d: %.60s: must follow the line of %.60s", item->file, item->line, item->key, of);
	} else {
		char *all = mem_printf("%s, %s", p->settings, item->value);
		free(p->settings);
		p->settings = all;
	}
	free(of);
	free(name);
	return true;
}

bool front_load(struct front *front, const char *path, struct err *err)
{
	*front = (struct front){ 0 };
	if (!conf_load(&front->conf, path, "", 0, err))
		return false;
	front->points = mem_new((size_t)front->conf.n + 1, sizeof *front->points);
	for (int i = 0; i < front->conf.n && !err_is(err); i++)
		if (!read_more(front, &front->conf.items[i], err) && read_point(&front->points[front->n], &front->conf.items[i], err))
			front->n++;
	return !err_is(err);
}

void front_free(struct front *front)
{
	for (int i = 0; i < front->n; i++) {
		free(front->points[i].stage);
		free(front->points[i].name);
		free(front->points[i].settings);
	}
	free(front->points);
	conf_free(&front->conf);
	*front = (struct front){ 0 };
}

static bool refuse(const struct conf_item *item, const char *rule, struct err *err)
{
	return err_set(err, "%s:%d: %s = %.60s: %s", item->file, item->line, item->key, item->value, rule);
}

static const struct conf_item *given(const struct conf *conf, const char *key)
{
	const struct conf_item *item = conf_find(conf, key, 0);
	return item && item->layer && *item->value ? item : 0;
}

static bool read_time(struct front_ask *ask, const struct conf_item *item, struct err *err)
{
	static const struct {
		const char *unit;
		double s;
	} units[] = { { "ms", 1e-3 }, { "s", 1 }, { "min", 60 }, { "h", 3600 } };
	char unit[8] = "";
	int end = 0;
	if (sscanf(item->value, "%lf %7s%n", &ask->value, unit, &end) == 2 && !item->value[end] && ask->value > 0 && isfinite(ask->value))
		for (int i = 0; i < COUNT(units); i++)
			if (!strcmp(unit, units[i].unit)) {
				ask->value *= units[i].s;
				strcpy(ask->unit, "s");
				return ask->time = true;
			}
	return refuse(item, "must be a time such as 2 s, 500 ms or 1 min", err);
}

static bool read_error(struct front_ask *ask, const struct conf_item *item, struct err *err)
{
	int end = 0;
	if (sscanf(item->value, "%lf %7s%n", &ask->value, ask->unit, &end) != 2 || item->value[end] || !(ask->value > 0)
	    || !isfinite(ask->value))
		return refuse(item, "must be an error with its unit, such as 0.05 mm or 2 %", err);
	return ask->error = true;
}

bool front_ask(struct front_ask *ask, const struct conf *conf, struct err *err)
{
	const struct conf_item *error = given(conf, "error"), *time = given(conf, "time"), *quality = given(conf, "quality");
	const struct conf_item *item = error ? error : time;
	*ask = (struct front_ask){ 0 };
	if (!item)
		return true;
	if (error && time)
		return refuse(error, "time is given too: give one of them", err);
	if (quality)
		return refuse(item, "quality is given too: give one of them", err);
	snprintf(ask->text, sizeof ask->text, "%s = %.40s", item->key, item->value);
	return error ? read_error(ask, item, err) : read_time(ask, item, err);
}

double front_seconds(const struct front_point *p, double mpx, double mtexel)
{
	return p->fixed_s + p->mpx_s * mpx + p->mtexel_s * mtexel;
}

/* The fastest point within the error, else the most exact one; -1: the stage's errors have another unit. */
static int within_error(const struct front *front, const struct front_ask *ask, const char *stage, double mpx, double mtexel)
{
	int best = -1;
	for (int i = 0; i < front->n; i++) {
		const struct front_point *p = &front->points[i], *b = best < 0 ? 0 : &front->points[best];
		if (strcmp(p->stage, stage) || strcmp(p->unit, ask->unit))
			continue;
		bool good = p->error <= ask->value, best_good = b && b->error <= ask->value;
		bool faster = b && front_seconds(p, mpx, mtexel) < front_seconds(b, mpx, mtexel);
		if (!b || (good ? !best_good || faster : !best_good && p->error < b->error))
			best = i;
	}
	return best;
}

static int fastest(const struct front *front, const char *stage, double mpx, double mtexel)
{
	int best = -1;
	for (int i = 0; i < front->n; i++)
		if (!strcmp(front->points[i].stage, stage)
		    && (best < 0 || front_seconds(&front->points[i], mpx, mtexel) < front_seconds(&front->points[best], mpx, mtexel)))
			best = i;
	return best;
}

/* Gain of going from point `now` to point `more`: decrease of the error's natural logarithm for each further second; 0 when
 * `more` is not more exact or takes more than the seconds left. */
static double worth(const struct front_point *now, const struct front_point *more, double mpx, double mtexel, double left_s)
{
	enum { ALL_EXACT = 20 };  // an error of exactly zero: nothing is left to save
	double cost = front_seconds(more, mpx, mtexel) - front_seconds(now, mpx, mtexel);
	if (!(more->error < now->error) || cost > left_s)
		return 0;
	double gain = more->error > 0 ? log(now->error / more->error) : ALL_EXACT;
	return gain / fmax(cost, 1e-6);
}

static void within_time(const struct front *front, const struct front_ask *ask, int n, const char *const stages[],
                        const bool runs[], double mpx, double mtexel, double others_s, int chosen[])
{
	double left = ask->value - others_s;
	for (int s = 0; s < n; s++) {
		chosen[s] = runs[s] ? fastest(front, stages[s], mpx, mtexel) : -1;
		left -= chosen[s] < 0 ? 0 : front_seconds(&front->points[chosen[s]], mpx, mtexel);
	}
	for (;;) {
		double best = 0;
		int stage = -1, point = -1;
		for (int s = 0; s < n; s++)
			for (int i = 0; chosen[s] >= 0 && i < front->n; i++) {
				if (strcmp(front->points[i].stage, stages[s]))
					continue;
				double w = worth(&front->points[chosen[s]], &front->points[i], mpx, mtexel, left);
				if (w > best) {
					best = w;
					stage = s;
					point = i;
				}
			}
		if (stage < 0)
			return;
		left -= front_seconds(&front->points[point], mpx, mtexel) - front_seconds(&front->points[chosen[stage]], mpx, mtexel);
		chosen[stage] = point;
	}
}

void front_choose(const struct front *front, const struct front_ask *ask, int n, const char *const stages[],
                  const bool runs[], double mpx, double mtexel, double others_s, int chosen[])
{
	for (int s = 0; s < n; s++)
		chosen[s] = ask->error && runs[s] ? within_error(front, ask, stages[s], mpx, mtexel) : -1;
	if (ask->time)
		within_time(front, ask, n, stages, runs, mpx, mtexel, others_s, chosen);
}
