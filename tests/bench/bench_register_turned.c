/* register_turned: the pairs of bench_register in other poses, units and windings: the 24 rotations of a cube, random rotations with units
 * from 0.001 to 1000, half of them wound the other way. Accepted, refused, and accepted though off by more than 1 % of the diagonal. */
#include <math.h>
#include <omp.h>
#include <stdio.h>

#include "base/mem.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/truth/pair.h"
#include "tests/lib/variants/turned.h"

static const char *const names[] = { "ict_id", "ict_id_noise", "ict_id_outliers", "ict_id_partial", "ict_id_rot20", "ict_id_26k", "ict_id_100k" };

struct tally {
	int all, accepted, wrong;
	double worst;  // true place, mean, per cent, of those accepted
};

static void one(struct tally *t, const struct pair *pair, int number, struct rng *rng)
{
	double r[3][3], scale = number < 24 ? 1 : pow(10, rng_range(rng, -3, 3));
	turned_rotation(r, number, rng);
	const double shift[3] = { scale * rng_range(rng, -500, 500), scale * rng_range(rng, -500, 500), scale * rng_range(rng, -500, 500) };
	struct mesh m = turned_mesh(&pair->source, (const double(*)[3])r, scale, shift, number & 1);
	struct transfer out;
	char reason[1024];
	t->all++;
	if (turned_lay(&out, reason, &m, &pair->target, 0)) {
		struct pair_error e = pair_measure(pair, (const float(*)[3])out.registered);
		t->accepted++;
		t->wrong += !(e.truth <= 1);
		t->worst = fmax(t->worst, e.truth);
	} else {
		fprintf(stderr, "%s, number %d, scale %g: %s\n", pair->name, number, scale, reason);
	}
	transfer_free(&out);
	mesh_free(&m);
}

int main(int argc, char **argv)
{
	enum { RANDOM = 20 };
	struct tally sum = { 0 };
	bench_open("register_turned", argc, argv);
	omp_set_num_threads(1);
	for (int i = 0; i < (bench_quick() ? 1 : COUNT(names)); i++) {
		struct pair pair;
		struct err err = { 0 };
		struct tally t = { 0 };
		struct rng rng = { 100 + (uint64_t)i };
		if (!pair_load(&pair, names[i], &err)) {
			fprintf(stderr, "bench_register_turned: %s: left out\n", err.msg);
			continue;
		}
		for (int k = bench_quick() ? 20 : 0; k < 24 + (bench_quick() ? 4 : RANDOM); k++)
			one(&t, &pair, k, &rng);
		printf("%-16s %d of %d accepted, %d wrong, worst true place %.3f %%\n", names[i], t.accepted, t.all, t.wrong, t.worst);
		sum.all += t.all;
		sum.accepted += t.accepted;
		sum.wrong += t.wrong;
		pair_free(&pair);
	}
	if (sum.all)
		bench_goal("characters in any pose, unit and winding: accepted though off by more than 1 % of the diagonal", "none", sum.wrong, "", !sum.wrong);
	return bench_close();
}
