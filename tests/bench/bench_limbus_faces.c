/* Both eyes of faces that had no part in development: right, wrong but called ok, refused, each eye by itself; left and right, pupils.
 * Drawn faces of the test split, half of them mirrored (tests/lib/unseen/faces.h); EYEWRIGHT_FACES=DIR: pictures of another renderer, too.
 * SEED=2 makes others (1: those that judge; develop on 1000 and above); CASES=100: so many. bench/limbus_faces.png: what failed.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "limbus/measure.h"
#include "math/stats.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/conf/limbus_conf.h"
#include "tests/lib/unseen/answer.h"
#include "tests/lib/unseen/crew.h"
#include "tests/lib/unseen/faces.h"
#include "tests/lib/unseen/tiles.h"

enum { DRAWN = 200, KINDS = 3 };
static const char *const kind_name[KINDS] = { "drawn (tests/evidence, test split)", "drawn, mirrored", "rendered (EYEWRIGHT_FACES)" };

struct seen { bool ok, right, rough, rough_off, swapped, pupil, pupil_wrong, shows; double error, ratio; struct ellipse e, truth; };
struct outcome { bool ran; int kind, parts; double seconds; struct seen eye[2]; };
struct faces { uint64_t seed; int drawn; struct outcome *outcome; };

static bool photograph(struct unseen *u, const struct faces *f, int i)
{
	if (i >= f->drawn)
		return faces_kept(u, i - f->drawn);
	*u = faces_make(f->seed, i, false, i % 2);
	return true;
}

static struct seen seen_of(const struct answer *a, const struct unseen *u, int side)
{
	const struct unseen_eye *eye = &u->eye[side];
	struct seen s = { .ok = a->ok, .error = NAN, .ratio = NAN, .e = a->e, .truth = eye->limbus, .shows = eye->showing >= 0.5 };
	s.rough = !a->ok && a->rough > 0 && a->rough <= ANSWER_ROUGH;
	s.rough_off = s.rough && ellipse_apart(&a->e, &eye->limbus) > a->rough * eye->limbus.a;
	if (!a->ok)
		return s;
	s.swapped = answer_meant(&a->e, u) != eye;
	s.error = ellipse_apart(&a->e, &eye->limbus);
	s.right = s.error <= answer_right() * eye->limbus.a;
	s.ratio = u->leans ? NAN : fabs(a->theta - eye->theta) / a->theta_sigma;
	s.pupil = a->has_pupil;
	const double off = fmax(hypot(a->pupil.cx - eye->pupil.cx, a->pupil.cy - eye->pupil.cy), fabs(a->pupil.a - eye->pupil.a));
	s.pupil_wrong = s.pupil && off > 0.1 * eye->limbus.a;
	return s;
}

static void one(void *ctx, int i)
{
	const struct faces *f = ctx;
	struct outcome *o = &f->outcome[i];
	struct unseen u;
	struct answer a[2];
	if (!photograph(&u, f, i))
		return;
	o->ran = true;
	o->kind = i >= f->drawn ? 2 : i % 2;
	o->parts = answer_face(a, &u.photo, u.aspect, o->kind == 1);
	o->seconds = a[0].seconds;
	for (int s = 0; s < 2; s++) {
		// One eye alone is that one; the other is not there.
		const struct answer none = { 0 };
		const bool other = o->parts == 1 && answer_meant(&a[0].e, &u) != &u.eye[s];
		o->eye[s] = seen_of(other ? &none : o->parts == 1 ? &a[0] : &a[s], &u, s);
	}
	unseen_free(&u);
}

struct count { int faces, both, n, right, wrong, refused, swapped, rough, rough_off, pupils, pupils_wrong, unlike, shows, shows_right; double ratio90, seconds; };

static struct count count_of(int n, const struct faces *f, int kind)
{
	struct count c = { .ratio90 = NAN, .seconds = NAN };
	double *ratio = mem_new(2 * (size_t)n + 1, sizeof *ratio), *seconds = mem_new((size_t)n + 1, sizeof *seconds);
	int ratios = 0;
	for (int i = 0; i < n; i++) {
		const struct outcome *o = &f->outcome[i];
		if (!o->ran || (kind >= 0 && o->kind != kind))
			continue;
		seconds[c.faces++] = o->seconds;
		c.both += o->parts == 2;
		for (int s = 0; s < 2; s++) {
			const struct seen *e = &o->eye[s];
			c.n++;
			c.right += e->right;
			c.wrong += e->ok && !e->right;
			c.refused += !e->ok;
			c.rough += e->rough;
			c.rough_off += e->rough_off;
			c.swapped += e->swapped;
			c.pupils += e->pupil && e->right;
			c.pupils_wrong += e->pupil_wrong && e->right;
			c.shows += e->shows;
			c.shows_right += e->shows && e->right;
			if (isfinite(e->ratio))
				ratio[ratios++] = e->ratio;
		}
	}
	if (ratios)
		c.ratio90 = stats_quantile(ratios, ratio, 0.9);
	if (c.faces)
		c.seconds = stats_median(c.faces, seconds);
	free(ratio);
	free(seconds);
	return c;
}

static double percent(int part, int of)
{
	return of ? 100.0 * part / of : NAN;
}

static void tell(int n, const struct faces *f)
{
	printf("%-36s %5s %7s %7s %7s %7s %7s %7s %8s %8s %7s %7s %9s\n", "", "faces", "both", "right", "WRONG", "refused", "rough", "off", "swapped", "half: ok", "pupils", "wrong", "tilt/sg90");
	for (int k = -1; k < KINDS; k++) {
		const struct count c = count_of(n, f, k);
		if (!c.faces)
			continue;
		printf("%-36s %5d %6.1f%% %6.1f%% %6.1f%% %6.1f%% %6.1f%% %6.1f%% %8d %7.1f%% %6.1f%% %6.1f%% %9.2f\n", k < 0 ? "all" : kind_name[k], c.faces, percent(c.both, c.faces),
		       percent(c.right, c.n), percent(c.wrong, c.n), percent(c.refused, c.n), percent(c.rough, c.n), percent(c.rough_off, c.n), c.swapped, percent(c.shows_right, c.shows), percent(c.pupils, c.right),
		       percent(c.pupils_wrong, c.pupils), c.ratio90);
	}
	const struct count c = count_of(n, f, -1);
	const struct bench_time time = { c.seconds, c.seconds, c.seconds };
	bench_row("faces, eyes right", "ours", "all", time, "photograph", percent(c.right, c.n), "%", "of both eyes");
	bench_row("faces, eyes wrong but called ok", "ours", "all", time, "photograph", percent(c.wrong, c.n), "%", "of both eyes");
}

static void goals(int n, const struct faces *f)
{
	const struct count c = count_of(n, f, -1);
	bench_goal("faces: left and right never swapped", "none", c.swapped, "eyes", c.swapped == 0);
	bench_goal("faces: both eyes looked at", ">= 95 %", percent(c.both, c.faces), "%", percent(c.both, c.faces) >= 95);
	bench_goal("faces: wrong but called ok", "<= 0.3 %", percent(c.wrong, c.n), "%", percent(c.wrong, c.n) <= 0.3);
	bench_goal("faces: eyes with half of the limbus showing found", ">= 98 %", percent(c.shows_right, c.shows), "%", percent(c.shows_right, c.shows) >= 98);
	bench_goal("faces: pupils of those off by more than a tenth of a", "<= 1 %", percent(c.pupils_wrong, c.pupils), "%", percent(c.pupils_wrong, c.pupils) <= 1);
}

static void sheet(int n, const struct faces *f)
{
	struct tiles *tiles = tiles_new();
	for (int i = 0; i < n; i++)
		for (int s = 0; s < 2; s++) {
			const struct seen *e = &f->outcome[i].eye[s];
			struct unseen u;
			if (!f->outcome[i].ran || e->right || (!e->ok && !e->shows) || !photograph(&u, f, i))
				continue;
			tiles_add(tiles, &u.photo, &u.eye[s].limbus, e->ok ? &e->e : 0, 2 * i + s);
			unseen_free(&u);
		}
	tiles_write(tiles, "limbus_faces.png");
}

static int setting(const char *key, int otherwise)
{
	const char *value = getenv(key);
	return value && *value ? atoi(value) : otherwise;
}

int main(int argc, char **argv)
{
	bench_open("limbus_faces", argc, argv);
	struct faces f = { .seed = (uint64_t)setting("SEED", 1) };
	f.drawn = setting("CASES", bench_quick() ? DRAWN / 10 : DRAWN);
	const int n = f.drawn + faces_kept_count();
	f.outcome = crew_array((size_t)n, sizeof *f.outcome);
	crew_run(n, one, &f);
	tell(n, &f);
	goals(n, &f);
	sheet(n, &f);
	return bench_close();
}
