#include "portrait.h"

static bool chance(struct rng *rng, double share)
{
	return rng_uniform(rng) < share;
}

static void darken(struct iris *iris, struct rng *rng)
{
	const float by = expf(range_of(rng, logf(0.06F), logf(0.6F)));
	for (int c = 0; c < 3; c++) {
		iris->outer[c] *= by;
		iris->inner[c] *= by;
		iris->gap[c] *= by;
	}
	iris->contrast *= range_of(rng, 0.2, 1);
}

/* Deep-set eyes, brows and light from above: what lies between the lids is darker under them and in its corners. */
static void shade(struct lid_shade *s, struct rng *rng)
{
	s->upper = range_of(rng, 0.3, 0.97);
	s->upper_mm = range_of(rng, 0.6, 4.5);
	s->lower = range_of(rng, 0, 0.7);
	s->lower_mm = range_of(rng, 0.4, 2);
	for (int k = 0; k < 2; k++) {
		s->corner[k] = chance(rng, 0.5) ? range_of(rng, 0.1, 0.5) : range_of(rng, 0.4, 0.97);
		s->corner_mm[k] = range_of(rng, 1.5, 8);
	}
	s->cast = chance(rng, 0.35) ? range_of(rng, 0.2, 0.9) : 0;
	s->cast_mm = range_of(rng, 0.3, 6);
	s->cast_soft = range_of(rng, 0.1, 1.5);
}

static void make_up(struct lids *l, struct rng *rng)
{
	l->liner = range_of(rng, 0.4, 1);
	l->liner_wide = range_of(rng, 0.5, 5);
	l->lash_wide = range_of(rng, 0.1, 0.4);
	l->lashes[0] = 60 + rng_below(rng, 110);
	l->lashes[1] = rng_below(rng, 60);
	l->lash_curl = range_of(rng, -0.9, 1);
	for (int c = 0; c < 3; c++)
		l->lash_rgb[c] *= 0.3F;
}

static void skin(struct face *f, struct rng *rng)
{
	f->rough = range_of(rng, 0.05, 0.3);
	f->wrinkle = range_of(rng, 0.05, 0.8);
	f->oil = range_of(rng, 0, 0.6);
	f->ring = range_of(rng, 0.3, 2.5);
}

void portrait_make(struct set *set, struct rng *rng)
{
	const bool dark = chance(rng, 0.5), made_up = chance(rng, 0.35), bright = chance(rng, 0.4), deep = chance(rng, 0.7);
	struct lid_shade s = set->face.lids[0].shade;
	if (deep)
		shade(&s, rng);
	const uint64_t seed = rng_bits(rng);
	for (int e = 0; e < 2; e++) {
		struct rng same = { seed };
		struct ball *b = &set->ball[e];
		set->face.lids[e].shade = s;
		if (dark)
			darken(&b->iris, &same);
		if (bright)
			for (int c = 0; c < 3; c++)
				b->sclera[c] = fminf(1.3F * b->sclera[c], 0.92F);
		if (made_up)
			make_up(&set->face.lids[e], &same);
	}
	if (chance(rng, 0.4))
		skin(&set->face, rng);
}
