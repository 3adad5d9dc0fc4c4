/* Finding the limbus of eyes that had no part in development (tests/lib/unseen): right, wrong but called ok, refused; by lids, light,
 * size and tilt. SEED=2 makes other eyes (1: those that judge; develop on 1000 and above); METHODS=1: the first method alone;
 * TOLERANCE=0.04: limbus.tolerance, by which right and wrong are told, too; CASES=100: so many, not timed at one size; EYEWRIGHT_TRACED=DIR: path-traced captures, too;
 * EYEWRIGHT_HEADS=FILE: photographs of heads, too. bench/limbus_unseen.cases.txt has every case, bench/limbus_unseen.png what failed.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/unseen/crew.h"
#include "tests/lib/unseen/rivals.h"
#include "tests/lib/unseen/tally.h"
#include "tests/lib/unseen/tiles.h"

enum { OURS, METHODS = 1 + RIVALS };
static const char *names[METHODS] = { "ours" };

struct split { uint64_t seed; int methods, made, traced; struct outcome *outcome; };  // made: photographs before the path-traced ones; traced: how many of those before heads

static bool photograph(struct unseen *u, const struct split *s, int i)
{
	*u = (struct unseen){ 0 };
	if (i >= s->made + s->traced)
		return unseen_heads(u, i - s->made - s->traced);
	if (i >= s->made)
		return unseen_traced(u, i - s->made);
	*u = unseen_make(s->seed, i);
	return true;
}

static void one(void *ctx, int i)
{
	const struct split *s = ctx;
	struct unseen u;
	struct outcome *o = &s->outcome[i];
	if (!photograph(&u, s, i))
		return;
	outcome_of(o, i, &u);
	struct answer a;
	answer_ours(&a, &u.photo, u.aspect);
	o->by[OURS] = verdict_of(&a, &u);
	for (int m = 1; m < s->methods; m++) {
		rival_answer(&a, (enum rival)(m - 1), &u.photo);
		o->by[m] = verdict_of(&a, &u);
	}
	unseen_free(&u);
}

static double percent(int part, int of)
{
	return of ? 100.0 * part / of : NAN;
}

static void table(int n, const struct split *s)
{
	for (int m = 0; m < s->methods; m++) {
		printf("%s\n%-36s %5s %7s %7s %7s %8s %11s %9s %10s %9s %11s %7s %7s %11s %10s %11s\n", names[m], "", "n", "right", "to 5 %", "WRONG", "refused", "half: found", "median px",
		       "90% err/sg", "tilt deg", "90% tilt/sg", "rough", "off", "half: rough", "90% err/sg", "90% tilt/sg");
		for (int b = 0; b < TALLY_BINS; b++) {
			const struct tally t = tally_make(n, s->outcome, m, b);
			if (t.n == 0)
				continue;
			printf("%-36s %5d %6.1f%% %6.1f%% %6.1f%% %7.1f%% %10.1f%% %9.3f %10.2f %9.2f %11.2f %6.1f%% %6.1f%% %10.1f%% %10.2f %11.2f\n", tally_bin[b], t.n,
			       percent(t.right, t.n), percent(t.near, t.n),
			       percent(t.wrong, t.n), percent(t.refused, t.n), percent(t.half_found, t.half), t.median_px, t.ratio90, t.tilt_median, t.tilt_ratio90,
			       percent(t.rough, t.n), percent(t.rough_off, t.n), percent(t.half_rough, t.half), t.rough_ratio90, t.rough_tilt_ratio90);
		}
	}
}

/* The share of gross errors by lids, light, size and tilt. */
static void gross(int n, const struct split *s)
{
	for (int b = 1; b < TALLY_BINS; b++) {
		const struct tally t = tally_make(n, s->outcome, OURS, b);
		if (t.n)
			bench_row("unseen eyes, wrong but called ok, by kind", names[OURS], tally_bin[b],
			          (struct bench_time){ NAN, NAN, NAN }, "photograph", percent(t.wrong, t.n), "%", "of these");
	}
}

static void pupils(int n, const struct split *s)
{
	const struct tally t = tally_make(n, s->outcome, OURS, 0);
	printf("pupils of the %d right ones: %d found, %d of them off by more than a tenth of a\n", t.right, t.pupils, t.pupils_wrong);
	bench_row("unseen eyes found, pupil wrong", names[OURS], "all", (struct bench_time){ NAN, NAN, NAN }, "photograph",
	          percent(t.pupils_wrong, t.pupils), "%", "of the pupils told");
}

static void rows(int n, const struct split *s)
{
	for (int m = 0; m < s->methods; m++) {
		const struct tally t = tally_make(n, s->outcome, m, 0);
		const struct bench_time time = { t.seconds, t.seconds, t.seconds };
		bench_row("unseen eyes found, error", names[m], "all", time, "photograph", t.median_px, "px", "median of those within 2 % of a");
		bench_row("unseen eyes found, tilt", names[m], "perspective, pupil, prior", time, "photograph", t.tilt_median, "deg", "median of theta");
		bench_row("unseen eyes found, tilt", names[m], "arccos(b / a), the paper's eq. 9", time, "photograph", t.weak_median, "deg", "median of theta");
		bench_row("unseen eyes, wrong but called ok", names[m], "all", time, "photograph", percent(t.wrong, t.n), "%", "of all");
		bench_row("unseen eyes, not found", names[m], "all", time, "photograph", 100 - percent(t.half_found, t.half), "%",
		          "of those with half of the limbus showing");
	}
}

/* Wall-clock times at 1600 x 1200, the methods one after the other. */
struct timed { int method; const struct unseen *u; };
static void answer_timed(void *ctx)
{
	const struct timed *t = ctx;
	struct answer a;
	if (t->method == OURS)
		answer_ours(&a, &t->u->photo, t->u->aspect);
	else
		rival_answer(&a, (enum rival)(t->method - 1), &t->u->photo);
}

static void times(const struct split *s)
{
	enum { EYES = 8 };
	double seconds[METHODS][EYES];
	const int n = bench_quick() ? 3 : EYES;
	for (int i = 0; i < n; i++) {
		struct unseen u = unseen_sized(s->seed, 3 * i, 1600, 1200);
		void (*fn[METHODS])(void *);
		void *ctx[METHODS];
		struct timed timed[METHODS];
		struct bench_time time[METHODS];
		for (int m = 0; m < s->methods; m++) {
			timed[m] = (struct timed){ m, &u };
			fn[m] = answer_timed;
			ctx[m] = &timed[m];
		}
		bench_times(s->methods, time, fn, ctx, 3);
		for (int m = 0; m < s->methods; m++)
			seconds[m][i] = time[m].median;
		unseen_free(&u);
	}
	for (int m = 0; m < s->methods; m++) {
		const struct bench_time time = bench_time_of(n, seconds[m]);
		bench_row("unseen eyes, 1600 x 1200", names[m], "all", time, "photograph", NAN, "", "");
		if (m == OURS)
			bench_goal("unseen eyes, 1600 x 1200: time, median", "<= 150 ms", 1000 * time.median, "ms", time.median <= 0.15);
	}
}

/* All that our method got wrong or refused though half of the limbus shows. */
static void sheet(int n, const struct split *s)
{
	struct tiles *tiles = tiles_new();
	for (int i = 0; i < n; i++) {
		const struct verdict *v = &s->outcome[i].by[OURS];
		if (v->right || (!v->ok && s->outcome[i].eye.showing < 0.5))
			continue;
		struct unseen u;
		if (!v->ran || !photograph(&u, s, i))
			continue;
		tiles_add(tiles, &u.photo, v->ok ? &answer_meant(&v->e, &u)->limbus : &u.eye[0].limbus, v->ok ? &v->e : 0, i);
		unseen_free(&u);
	}
	tiles_write(tiles, "limbus_unseen.png");
}

static void goals(int n, const struct split *s)
{
	const struct tally t = tally_make(n, s->outcome, OURS, 0);
	const double wrong = percent(t.wrong, t.n), found = percent(t.half_found, t.half);
	bench_goal("unseen eyes: wrong but called ok", "<= 0.3 %", wrong, "%", wrong <= 0.3);
	bench_goal("unseen eyes with half of the limbus showing: found", ">= 98 %", found, "%", found >= 98);
	bench_goal("unseen eyes found: error, median", "<= 0.1 px", t.median_px, "px", t.median_px <= 0.1);
	bench_goal("unseen eyes called ok: error over sigma, 90 %", "<= 2", t.ratio90, "", t.ratio90 <= 2);
	bench_goal("unseen eyes called ok: tilt's error over sigma, 90 %", "<= 2", t.tilt_ratio90, "", t.tilt_ratio90 <= 2);
}

static int setting(const char *key, int otherwise)
{
	const char *value = getenv(key);
	return value && *value ? atoi(value) : otherwise;
}

int main(int argc, char **argv)
{
	bench_open("limbus_unseen", argc, argv);
	for (int m = 1; m < METHODS; m++)
		names[m] = rival_name[m - 1];
	if (getenv("TOLERANCE"))
		answer_conf()->tolerance = fmin(fmax(atof(getenv("TOLERANCE")), 0.01), 0.06);
	struct split s = { .seed = (uint64_t)setting("SEED", 1), .methods = setting("METHODS", METHODS) };
	s.made = setting("CASES", bench_quick() ? UNSEEN_COUNT / 10 : UNSEEN_COUNT);
	s.traced = unseen_traced_count();
	const int n = s.made + s.traced + unseen_heads_count();
	s.outcome = crew_array((size_t)n, sizeof *s.outcome);
	crew_run(n, one, &s);
	table(n, &s);
	gross(n, &s);
	pupils(n, &s);
	rows(n, &s);
	goals(n, &s);
	sheet(n, &s);
	if (!getenv("CASES"))
		times(&s);
	char *path = mem_printf("%s/limbus_unseen.cases.txt", bench_out());
	if (!tally_csv(path, n, s.outcome, s.methods, names))
		fprintf(stderr, "%s: cannot be written\n", path);
	free(path);
	return bench_close();
}
