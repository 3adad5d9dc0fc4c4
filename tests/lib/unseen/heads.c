#include <stdio.h>
#include <stdlib.h>

#include "tests/evidence/kept.h"
#include "tests/lib/unseen/unseen_impl.h"

int unseen_heads_count(void)
{
	FILE *file = getenv("EYEWRIGHT_HEADS") ? fopen(getenv("EYEWRIGHT_HEADS"), "rb") : 0;
	int n = 0;
	struct drawn d;
	for (; file && kept_next(&d, file); n++)
		drawn_free(&d);
	if (file)
		fclose(file);
	return n;
}

/* The eye that shows most, its centre in the picture; -1: none shows. */
static int asked_for(const struct drawn *d)
{
	int best = -1;
	for (int k = 0; k < d->n_eyes; k++) {
		const struct drawn_eye *e = &d->eye[k];
		if (e->shown > 0.2F && e->limbus[0] > 0 && e->limbus[0] < d->width && e->limbus[1] > 0 && e->limbus[1] < d->height
		    && (best < 0 || e->shown > d->eye[best].shown))
			best = k;
	}
	return best;
}

bool unseen_heads(struct unseen *u, int k)
{
	FILE *file = fopen(getenv("EYEWRIGHT_HEADS"), "rb");
	struct drawn d = { 0 };
	bool ok = file != 0;
	for (int i = 0; ok && i <= k; i++) {
		drawn_free(&d);
		ok = kept_next(&d, file);
	}
	if (file)
		fclose(file);
	const int asked = ok ? asked_for(&d) : -1;
	if (asked >= 0) {
		*u = (struct unseen){ .photo = unseen_photo(d.rgb, d.width, d.height), .maker = UNSEEN_HEADS, .aspect = 1, .warmth = 1, .opening = d.eye[asked].shown, .n = 1 };
		u->eye[0] = unseen_eye_of(&d, asked);
		if (d.n_eyes > 1 && d.eye[1 - asked].shown > 0.02F)
			u->eye[u->n++] = unseen_eye_of(&d, 1 - asked);
	}
	drawn_free(&d);
	return asked >= 0;
}
