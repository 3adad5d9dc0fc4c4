/* The same eye in an altered photograph: mirrored, turned, cropped, half the size, in other light, otherwise exposed. Share of pairs whose
 * ellipses are within 0.3 % of a, of those that are not both refused; and what is right, or wrong and called ok, by truth. SEED, CASES,
 * EYEWRIGHT_TRACED as bench_limbus_unseen.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "tests/lib/bench/bench.h"
#include "tests/lib/unseen/altered.h"
#include "tests/lib/unseen/answer.h"
#include "tests/lib/unseen/crew.h"

enum verdict { SAME_ELLIPSE, BOTH_REFUSED, ONE_REFUSED, OTHER_ELLIPSE, VERDICTS };

struct pair { enum verdict verdict; bool ran, right, wrong; };
struct eyes { uint64_t seed; int made; struct pair (*pair)[ALTERED_ALL]; };  // made: photographs before the path-traced ones

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

/* Path-traced photographs come in pairs: the first is in balanced light. */
static bool photograph(struct unseen *u, const struct eyes *s, int eye)
{
	*u = (struct unseen){ 0 };
	if (eye >= s->made)
		return unseen_traced(u, 2 * (eye - s->made));
	*u = eye_of(s->seed, eye);
	return true;
}

/* By the eye of the changed photograph that the answer is nearest to. */
static bool is_right(const struct answer *a, const struct unseen *u, const struct altered *how)
{
	for (int k = 0; k < u->n; k++) {
		const struct ellipse meant = altered_ellipse(&u->eye[k].limbus, &u->photo, how, &u->eye[0].limbus);
		if (ellipse_apart(&a->e, &meant) <= answer_right() * meant.a)
			return true;
	}
	return false;
}

static void one(void *ctx, int eye)
{
	const struct eyes *s = ctx;
	struct unseen u;
	struct answer first, again;
	if (!photograph(&u, s, eye))
		return;
	answer_ours(&first, &u.photo, u.aspect);
	for (int i = 0; i < ALTERED_ALL; i++) {
		const struct altered how = altered_all(i);
		struct photo photo = altered_photo(&u.photo, &how, &u.eye[0].limbus);
		struct pair *p = &s->pair[eye][i];
		answer_ours(&again, &photo, u.aspect);
		*p = (struct pair){ .verdict = first.ok || again.ok ? ONE_REFUSED : BOTH_REFUSED, .ran = true, .right = again.ok && is_right(&again, &u, &how) };
		p->wrong = again.ok && !p->right;
		if (first.ok && again.ok) {
			const struct ellipse meant = altered_ellipse(&first.e, &u.photo, &how, &u.eye[0].limbus);
			p->verdict = ellipse_apart(&again.e, &meant) <= same * meant.a ? SAME_ELLIPSE : OTHER_ELLIPSE;
		}
		photo_free(&photo);
	}
	unseen_free(&u);
}

int main(int argc, char **argv)
{
	bench_open("limbus_altered", argc, argv);
	const char *seed = getenv("SEED"), *cases = getenv("CASES");
	struct eyes s = { .seed = seed ? strtoull(seed, 0, 10) : 1, .made = cases ? atoi(cases) : bench_quick() ? 4 : 40 };
	const int n = s.made + unseen_traced_count() / 2;
	int all[VERDICTS] = { 0 }, pairs = 0;
	s.pair = crew_array((size_t)n, sizeof *s.pair);
	crew_run(n, one, &s);
	for (int kind = 0; kind < ALTERED_KINDS; kind++) {
		int count[VERDICTS] = { 0 }, total = 0, right = 0, wrong = 0;
		for (int e = 0; e < n; e++)
			for (int i = 0; i < ALTERED_ALL; i++) {
				const struct pair *p = &s.pair[e][i];
				if (altered_all(i).kind != kind || !p->ran)
					continue;
				count[p->verdict]++;
				all[p->verdict]++;
				total++;
				right += p->right;
				wrong += p->wrong;
			}
		pairs += total;
		printf("%-28s %4d pairs: same %d, both refused %d, one refused %d, another ellipse %d; right %d, WRONG %d, refused %d\n", altered_kind[kind], total,
		       count[SAME_ELLIPSE], count[BOTH_REFUSED], count[ONE_REFUSED], count[OTHER_ELLIPSE], right, wrong, total - right - wrong);
		bench_row("the same eye in an altered photograph", "ours", altered_kind[kind], (struct bench_time){ NAN, NAN, NAN }, "photograph",
		          100.0 * (count[ONE_REFUSED] + count[OTHER_ELLIPSE]) / total, "%", "not the same within 0.3 % of a");
	}
	const double share = 100.0 * all[SAME_ELLIPSE] / (pairs - all[BOTH_REFUSED]);
	bench_goal("altered photographs, not both refused: the same within 0.3 % of a", ">= 99 %", share, "%", share >= 99);
	return bench_close();
}
