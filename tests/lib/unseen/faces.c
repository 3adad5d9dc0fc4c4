#include "tests/lib/unseen/faces.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/rng.h"
#include "tests/evidence/scene.h"
#include "tests/lib/unseen/unseen_impl.h"

enum { TINY = 16 };  // times as small: a first picture, to see where the other eye lies

struct shot { int width, height; double radius, x, y, turn; bool mirrored, training; };

static struct drawn shoot(uint64_t number, const struct shot *s, double x, double y, int smaller)
{
	const struct drawn_view view = { .radius = (float)(s->radius / smaller), .x = (float)(x / smaller), .y = (float)(y / smaller), .turn = (float)s->turn,
		.mirrored = s->mirrored, .training = s->training };
	return drawn_photograph(number, &view, s->width / smaller, s->height / smaller);
}

/* Where the other eye lies from the one that is asked for, px. */
static bool between(double to[2], uint64_t number, const struct shot *s)
{
	struct drawn d = shoot(number, s, s->x, s->y, TINY);
	const bool two = d.n_eyes == 2;
	if (two) {
		const float *a = d.eye[0].limbus, *b = d.eye[1].limbus;
		const bool first = hypot(a[0] - s->x / TINY, a[1] - s->y / TINY) < hypot(b[0] - s->x / TINY, b[1] - s->y / TINY);
		for (int i = 0; i < 2; i++)
			to[i] = TINY * (first ? b[i] - a[i] : a[i] - b[i]);
	}
	drawn_free(&d);
	return two;
}

static bool draw(struct unseen *u, uint64_t number, const struct shot *s)
{
	double to[2];
	if (!between(to, number, s))
		return false;
	struct drawn d = shoot(number, s, s->x - to[0] / 2, s->y - to[1] / 2, 1);
	bool whole = d.n_eyes == 2;
	for (int k = 0; k < 2 && whole; k++) {
		const float *l = d.eye[k].limbus;
		whole = l[0] > l[2] && l[1] > l[2] && l[0] < d.width - l[2] && l[1] < d.height - l[2] && d.eye[k].openness > 0.4F;
	}
	if (whole) {
		// The line through both lies within 45 degrees of the rows: the eye farther right is the person's left one, if not mirrored.
		const int left = (d.eye[0].limbus[0] > d.eye[1].limbus[0]) != s->mirrored ? 0 : 1;
		*u = (struct unseen){ .photo = unseen_photo(d.rgb, d.width, d.height), .n = 2, .maker = UNSEEN_DRAWN, .opening = d.eye[0].openness,
			.warmth = d.white[0] / d.white[2], .white = { d.white[0], d.white[1], d.white[2] }, .aspect = d.aspect, .leans = unseen_leans(&d, s->turn) };
		u->eye[FACES_LEFT] = unseen_eye_of(&d, left);
		u->eye[FACES_RIGHT] = unseen_eye_of(&d, 1 - left);
	}
	drawn_free(&d);
	return whole;
}

struct unseen faces_make(uint64_t seed, int i, bool training, bool mirrored)
{
	struct rng rng = { seed * 0x9e3779b97f4a7c15 + 0x5bd1e995 + (uint64_t)i };
	struct unseen u = { 0 };
	rng_bits(&rng);
	for (bool made = false; !made;) {
		struct shot s = { .mirrored = mirrored, .training = training, .turn = 0.15 * rng_normal(&rng) };
		s.radius = exp(rng_range(&rng, log(20), log(80)));
		s.width = (int)fmin(1600, fmax(640, s.radius * rng_range(&rng, 17, 60)));
		s.height = (int)(s.width * rng_range(&rng, 0.7, 1.2));
		s.radius = fmin(s.radius, s.width / 17.0);
		s.x = s.width * rng_range(&rng, 0.47, 0.53);
		s.y = s.height * rng_range(&rng, 0.4, 0.6);
		made = fabs(s.turn) < 0.6 && draw(&u, rng_bits(&rng) >> 20, &s);
	}
	return u;
}

static int is_truth(const struct dirent *d)
{
	const char *dot = strrchr(d->d_name, '.');
	return dot && !strcmp(dot, ".truth");
}

static int kept(struct dirent ***list)
{
	const char *dir = getenv("EYEWRIGHT_FACES");
	const int n = dir ? scandir(dir, list, is_truth, alphasort) : 0;
	return n > 0 ? n : 0;
}

static void release(int n, struct dirent **list)
{
	for (int i = 0; i < n; i++)
		free(list[i]);
	free(list);
}

int faces_kept_count(void)
{
	struct dirent **list = 0;
	const int n = kept(&list);
	release(n, list);
	return n;
}

static bool truth_read(struct unseen *u, const char *path)
{
	FILE *f = fopen(path, "r");
	char line[400], side[16];
	int seen = 0;
	while (f && fgets(line, sizeof line, f)) {
		struct unseen_eye e;
		double v[12];
		if (sscanf(line, "%15s %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf %lf", side, v, v + 1, v + 2, v + 3, v + 4, v + 5, v + 6, v + 7, v + 8, v + 9,
		           v + 10, v + 11) != 13)
			continue;
		e = (struct unseen_eye){ { v[0], v[1], v[2], v[3], v[4] * M_PI / 180 }, { v[7], v[8], v[9], v[10], v[11] * M_PI / 180 }, v[5], v[6] * M_PI / 180 };
		u->eye[strcmp(side, "right") ? FACES_LEFT : FACES_RIGHT] = e;
		seen++;
	}
	if (f)
		fclose(f);
	return seen == 2;
}

bool faces_kept(struct unseen *u, int k)
{
	struct dirent **list = 0;
	const int n = kept(&list);
	*u = (struct unseen){ .n = 2, .maker = UNSEEN_TRACED, .aspect = 1, .warmth = 1 };
	char *truth = mem_printf("%s/%s", getenv("EYEWRIGHT_FACES"), list[k]->d_name), *picture = mem_printf("%.*s.png", (int)(strlen(truth) - strlen(".truth")), truth);
	struct err err = { 0 };
	const bool ok = truth_read(u, truth) && photo_load(&u->photo, picture, 100, &err);
	if (!ok)
		fprintf(stderr, "%s: %s\n", truth, err_is(&err) ? err.msg : "no truth of two eyes");
	free(truth);
	free(picture);
	release(n, list);
	return ok;
}
