/* The same eye in an altered photograph: mirrored, turned, cropped, half the size, in other light, otherwise exposed. Share of pairs whose
 * ellipses are within 0.3 % of a, of those that are not both refused. SEED, CASES as bench_limbus_unseen.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/lib/bench/bench.h"
#include "tests/lib/unseen/altered.h"
#include "tests/lib/unseen/answer.h"
#include "tests/lib/unseen/crew.h"

enum verdict { SAME_ELLIPSE, BOTH_REFUSED, ONE_REFUSED, OTHER_ELLIPSE, VERDICTS };

struct pair { enum verdict verdict; double off; };
struct eyes { uint64_t seed; struct pair (*pair)[ALTERED_ALL]; };

static const double same = 0.003;  // of a

/* The eye-th photograph whose eye is large enough to be halved and half of whose limbus shows. */
static struct unseen eye_of(uint64_t seed, int eye)
{
	// Eyes are spread over the split, so that each is found without drawing those before it.
	for (int i = 20 * eye;; i++) {
		struct unseen u = unseen_make(seed, i);
		if (u.eye[0].limbus.a >= 60 && u.eye[0].showing >= 0.5 && u.photo.width * u.photo.height < 1000000)
			return u;
		unseen_free(&u);
	}
}

static void one(void *ctx, int eye)
{
	const struct eyes *s = ctx;
	struct unseen u = eye_of(s->seed, eye);
	struct answer first, again;
	answer_ours(&first, &u.photo, u.aspect);
	for (int i = 0; i < ALTERED_ALL; i++) {
		const struct altered how = altered_all(i);
		struct photo photo = altered_photo(&u.photo, &how, &u.eye[0].limbus);
		struct pair *p = &s->pair[eye][i];
		answer_ours(&again, &photo, u.aspect);
		*p = (struct pair){ first.ok || again.ok ? ONE_REFUSED : BOTH_REFUSED, NAN };
		if (first.ok && again.ok) {
			const struct ellipse meant = altered_ellipse(&first.e, &u.photo, &how, &u.eye[0].limbus);
			p->off = answer_error(&again.e, &meant) / meant.a;
			p->verdict = p->off <= same ? SAME_ELLIPSE : OTHER_ELLIPSE;
		}
		photo_free(&photo);
	}
	unseen_free(&u);
}

int main(int argc, char **argv)
{
	bench_open("limbus_altered", argc, argv);
	const char *seed = getenv("SEED"), *cases = getenv("CASES");
	const int n = cases ? atoi(cases) : bench_quick() ? 4 : 40;
	struct eyes s = { .seed = seed ? strtoull(seed, 0, 10) : 1, .pair = crew_array((size_t)n, sizeof *s.pair) };
	crew_run(n, one, &s);
	int all[VERDICTS] = { 0 };
	for (int kind = 0; kind < ALTERED_KINDS; kind++) {
		int count[VERDICTS] = { 0 }, total = 0;
		for (int e = 0; e < n; e++)
			for (int i = 0; i < ALTERED_ALL; i++)
				if (altered_all(i).kind == kind) {
					count[s.pair[e][i].verdict]++;
					all[s.pair[e][i].verdict]++;
					total++;
				}
		printf("%-28s %4d pairs: same %d, both refused %d, one refused %d, another ellipse %d\n", altered_kind[kind], total, count[SAME_ELLIPSE],
		       count[BOTH_REFUSED], count[ONE_REFUSED], count[OTHER_ELLIPSE]);
		bench_row("the same eye in an altered photograph", "ours", altered_kind[kind], (struct bench_time){ NAN, NAN, NAN }, "photograph",
		          100.0 * (count[ONE_REFUSED] + count[OTHER_ELLIPSE]) / total, "%", "not the same within 0.3 % of a");
	}
	const double share = 100.0 * all[SAME_ELLIPSE] / (n * ALTERED_ALL - all[BOTH_REFUSED]);
	bench_goal("altered photographs, not both refused: the same within 0.3 % of a", ">= 99 %", share, "%", share >= 99);
	return bench_close();
}
