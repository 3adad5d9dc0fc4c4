/* Pictures that hold no limbus to measure: each must be refused. SEED, CASES (of each kind) as bench_limbus_unseen; what was taken for an
 * eye stands in bench/limbus_bad.png.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/unseen/answer.h"
#include "tests/lib/unseen/crew.h"
#include "tests/lib/unseen/no_eye.h"
#include "tests/lib/unseen/tiles.h"

struct bad { uint64_t seed; int of_each; bool *taken; double *rough; struct ellipse *e; };  // rough: to which it is known, refused; 0: to none

static void one(void *ctx, int i)
{
	const struct bad *b = ctx;
	struct photo photo = no_eye_make(b->seed, i / b->of_each, i % b->of_each);
	struct answer a;
	answer_ours(&a, &photo, NAN);
	b->taken[i] = a.ok;
	b->rough[i] = a.rough;
	b->e[i] = a.e;
	photo_free(&photo);
}

int main(int argc, char **argv)
{
	bench_open("limbus_bad", argc, argv);
	const char *seed = getenv("SEED"), *cases = getenv("CASES");
	struct bad b = { .seed = seed ? strtoull(seed, 0, 10) : 1, .of_each = cases ? atoi(cases) : bench_quick() ? 3 : 30 };
	const int n = NO_EYE_KINDS * b.of_each;
	int all = 0;
	b.taken = crew_array((size_t)n, sizeof *b.taken);
	b.rough = crew_array((size_t)n, sizeof *b.rough);
	b.e = crew_array((size_t)n, sizeof *b.e);
	crew_run(n, one, &b);
	struct tiles *tiles = tiles_new();
	for (int kind = 0; kind < NO_EYE_KINDS; kind++) {
		int taken = 0, rough = 0, used = 0;
		for (int i = 0; i < b.of_each; i++) {
			const int at = kind * b.of_each + i;
			taken += b.taken[at];
			rough += b.rough[at] > 0;
			used += b.rough[at] > 0 && b.rough[at] <= ANSWER_ROUGH;
			if (!b.taken[at])
				continue;
			struct photo photo = no_eye_make(b.seed, kind, i);
			tiles_add(tiles, &photo, 0, &b.e[at], 1000 * kind + i);
			photo_free(&photo);
		}
		all += taken;
		printf("%-24s %d of %d taken for an eye, %d known roughly, %d well enough to be used\n", no_eye_kind[kind], taken, b.of_each, rough, used);
		bench_row("no eye, but called ok", "ours", no_eye_kind[kind], (struct bench_time){ NAN, NAN, NAN }, "photograph", 100.0 * taken / b.of_each, "%", "of all");
	}
	bench_goal("pictures without a limbus to measure: refused", "all", n - all, mem_printf("of %d", n), all == 0);
	tiles_write(tiles, "limbus_bad.png");
	return bench_close();
}
