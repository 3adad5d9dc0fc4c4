#include "limbus/propose/flank.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "limbus/propose/flank_map.h"

enum { ANGLES = 24, ROLLS = 2, PER_LEVEL = 16, LEVELS = 8, RADII = 8, STRIDE = 2 };
static const float LEAST = -0.3f, MOST = 0.7f;  // a step counts no further
#define GAP FLANK_GAP
static const double FINEST = 8, RATIO = 1.1;    // px on a level: the smallest radius looked for; RADII of them an octave
static const double FLANK_SCORE = 0.3;          // below this nothing stands out

struct circle {
	float x, y, r, score;  // px of the map
};

struct compass {
	float c[ANGLES], s[ANGLES];
};

static struct compass compass_make(void)
{
	struct compass k;
	for (int i = 0; i < ANGLES; i++) {
		k.c[i] = (float)cos(2 * M_PI * i / ANGLES);
		k.s[i] = (float)sin(2 * M_PI * i / ANGLES);
	}
	return k;
}

/* Mean of the steps of n angles from `first` on, one way round or the other. */
static float sector(const float step[ANGLES], int first, int n, int way)
{
	float sum = 0;
	for (int i = 0; i < n; i++)
		sum += step[(first + way * i + 2 * ANGLES) % ANGLES];
	return sum / (float)n;
}

/* Both sides from 45 degrees above the middle to 60 below it, and what lies beneath: the better side, most of the other,
 * a little of the lower rim. The head may lean. slit: only the 45 degrees that lids leave open last. */
static float circle_score(const struct log_map *m, const struct circle *o, const struct compass *compass, double gap, bool slit)
{
	float step[ANGLES], best = -1, in = (float)(1 - gap) * o->r, out = (float)(1 + gap) * o->r;
	for (int i = 0; i < ANGLES; i++) {
		float c = compass->c[i], s = compass->s[i];
		float d = log_map_step(m, o->x + in * c, o->y + in * s, o->x + out * c, o->y + out * s);
		step[i] = d < LEAST ? LEAST : d > MOST ? MOST : d;
	}
	for (int roll = -ROLLS; roll <= ROLLS; roll++) {
		float right = sector(step, roll - (slit ? 1 : 3), slit ? 3 : 8, 1);
		float left = sector(step, ANGLES / 2 + roll + (slit ? 1 : 3), slit ? 3 : 8, -1);
		float below = slit ? 0 : sector(step, ANGLES / 4 + roll - 2, 5, 1);
		float score = fmaxf(right, left) + 0.7f * fminf(right, left) + 0.3f * below - 0.02f * fabsf((float)roll);
		best = fmaxf(best, score);
	}
	return best;
}

static bool alike(const struct circle *a, const struct circle *b)
{
	float r = fmaxf(a->r, b->r);
	return hypotf(a->x - b->x, a->y - b->y) < 0.25f * r && fabsf(logf(a->r / b->r)) < 0.25f;
}

/* Into a list ordered by score; of circles that are alike only the best stays. */
static void keep(struct circle *list, int *n, int max, const struct circle *o)
{
	for (int i = 0; i < *n; i++)
		if (alike(&list[i], o)) {
			if (list[i].score >= o->score)
				return;
			memmove(list + i, list + i + 1, (size_t)(*n - i - 1) * sizeof *list);
			--*n;
			i--;
		}
	int at = *n;
	while (at > 0 && list[at - 1].score < o->score)
		at--;
	if (at >= max)
		return;
	*n += *n < max;
	memmove(list + at + 1, list + at, (size_t)(*n - at - 1) * sizeof *list);
	list[at] = *o;
}

/* Uphill over centre and radius. */
static void climb(struct circle *o, const struct log_map *m, const struct compass *compass)
{
	for (float step = 1; step > 0.2f; step /= 2)
		for (bool moved = true; moved;) {
			moved = false;
			for (int i = 0; i < 6; i++) {
				struct circle p = *o;
				*(i / 2 == 0 ? &p.x : i / 2 == 1 ? &p.y : &p.r) += i % 2 ? -step : step;
				p.score = p.r > 4 ? circle_score(m, &p, compass, GAP, false) : -1;
				if (p.score > o->score + 1e-6f) {
					*o = p;
					moved = true;
				}
			}
		}
}

/* The best circles of one level, in px of the photograph. */
static int search_level(struct circle out[PER_LEVEL], const struct log_map *m, const double *hint, double lo, double hi)
{
	const struct compass compass = compass_make();
	int n = 0;
	for (int k = 0; k < RADII; k++) {
		float r = (float)(FINEST * pow(RATIO, k));
		double real = (double)r * m->scale;
		if (real < lo || real > hi)
			continue;
		for (int y = (int)(0.4f * r); (float)y < (float)m->height - 0.4f * r; y += STRIDE)
			for (int x = (int)(0.4f * r); (float)x < (float)m->width - 0.4f * r; x += STRIDE) {
				struct circle o = { (float)x, (float)y, r, 0 };
				if (hint && hypot((x + 0.5) * m->scale + m->x0 - hint[0], (y + 0.5) * m->scale + m->y0 - hint[1]) > 0.7 * hint[2])
					continue;
				o.score = circle_score(m, &o, &compass, GAP, false);
				if (o.score > (float)FLANK_SCORE && (n < PER_LEVEL || o.score > out[n - 1].score))
					keep(out, &n, PER_LEVEL, &o);
			}
	}
	for (int i = 0; i < n; i++) {
		climb(&out[i], m, &compass);
		out[i].x = (float)((out[i].x + 0.5f) * m->scale + m->x0);
		out[i].y = (float)((out[i].y + 0.5f) * m->scale + m->y0);
		out[i].r *= (float)m->scale;
	}
	return n;
}

int limbus_flanks(struct seek_found out[SEEK_MAX], const struct photo *photo, const double *hint, double lo, double hi)
{
	double box[4] = { 0, 0, photo->width, photo->height };
	struct log_map map[LEVELS];
	struct circle part[LEVELS][PER_LEVEL], all[SEEK_MAX];
	int count[LEVELS], levels = 0, n = 0;
	if (hint) {
		lo = hint[2] / 1.5;
		hi = 1.5 * hint[2];
		for (int i = 0; i < 4; i++)
			box[i] = hint[i % 2] + (i < 2 ? -3 : 3) * hint[2];
	}
	map[levels++] = log_map_make(photo, box, lo / FINEST);
	while (levels < LEVELS && map[levels - 1].scale * FINEST * 2 < hi && map[levels - 1].width > 40 && map[levels - 1].height > 40) {
		map[levels] = log_map_halve(&map[levels - 1]);
		levels++;
	}
#pragma omp parallel for schedule(dynamic, 1)
	for (int l = 0; l < levels; l++)
		count[l] = search_level(part[l], &map[l], hint, lo, hi);
	for (int l = 0; l < levels; l++) {
		for (int i = 0; i < count[l]; i++)
			keep(all, &n, SEEK_MAX, &part[l][i]);
		free(map[l].px);
	}
	for (int i = 0; i < n; i++)
		out[i] = (struct seek_found){ { (double)all[i].x, (double)all[i].y, (double)all[i].r, (double)all[i].r, 0 }, (double)all[i].score };
	return n;
}

/* The best circle of radius r whose centre is within a tenth of it of (x, y). */
static struct circle best_near(const struct log_map *m, float x, float y, float r, const struct compass *compass,
                               double gap)
{
	struct circle best = { x, y, r, 0 };
	for (int i = 0; i < 9; i++) {
		struct circle o = { x + 0.1f * r * (float)(i % 3 - 1), y + 0.1f * r * (float)(i / 3 - 1), r, 0 };
		o.score = circle_score(m, &o, compass, gap, true);
		if (o.score > best.score)
			best = o;
	}
	return best;
}

int limbus_flank_around(struct seek_found out[FLANK_ROUND], const struct photo *photo, const struct ellipse *e, double gap)
{
	enum { STEPS = 15 };
	const struct compass compass = compass_make();
	double reach = 5.2 * e->a, box[4] = { e->cx - reach, e->cy - reach, e->cx + reach, e->cy + reach };
	struct log_map m = log_map_make(photo, box, e->a / FINEST);
	float x = (float)((e->cx - m.x0) / m.scale - 0.5), y = (float)((e->cy - m.y0) / m.scale - 0.5), a = (float)(e->a / m.scale);
	struct circle at[STEPS + 2] = { 0 }, top[FLANK_ROUND];
	int n = 0;
	for (int i = 1; i <= STEPS; i++)
		at[i] = best_near(&m, x, y, 1.5f * powf(1.08f, (float)(i - 1)) * a, &compass, gap);
	for (int i = 1; i <= STEPS; i++)
		if (at[i].score > at[i - 1].score && at[i].score >= at[i + 1].score)
			keep(top, &n, FLANK_ROUND, &at[i]);
	for (int i = 0; i < n; i++) {
		double r = (double)top[i].r * m.scale;
		out[i] = (struct seek_found){ { ((double)top[i].x + 0.5) * m.scale + m.x0, ((double)top[i].y + 0.5) * m.scale + m.y0, r, r, 0 },
		                              (double)top[i].score };
	}
	free(m.px);
	return n;
}
