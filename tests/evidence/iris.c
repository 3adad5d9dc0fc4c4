#include "iris.h"

static float range(struct rng *rng, double lo, double hi)
{
	return (float)rng_range(rng, lo, hi);
}

/* A stroma that scatters blue over melanin that absorbs it; brown 0 blue .. 1 near black. */
static void stroma(float out[3], float brown, float green, float bright)
{
	static const float blue[3] = { 0.13F, 0.20F, 0.29F }, grey[3] = { 0.22F, 0.24F, 0.25F }, sigma[3] = { 2.2F, 3.6F, 6.5F };
	const float depth = brown * brown * 1.3F + 0.16F * green;
	for (int c = 0; c < 3; c++)
		out[c] = bright * (blue[c] + (grey[c] - blue[c]) * (bright > 1 ? bright - 1 : 0)) * expf(-sigma[c] * depth)
		         * (1 + (c == 0 ? 2.2F : c == 1 ? 1.0F : 0.2F) * fminf(2.5F * brown, 1));
}

static void colours(struct iris *iris, struct rng *rng)
{
	const int which = rng_below(rng, 10);
	float brown = which < 4 ? range(rng, 0, 0.25) : which < 6 ? range(rng, 0.2, 0.55) : which < 9 ? range(rng, 0.5, 0.85) : range(rng, 0.85, 1.1);
	const float green = which < 6 ? range(rng, 0, 1.3) : 0.5F, bright = which < 2 ? range(rng, 0.8, 2.3) : range(rng, 0.55, 1.7);
	stroma(iris->outer, brown, green, bright);
	const float inner = brown + (rng_below(rng, 2) ? range(rng, 0, 0.5) : range(rng, -0.1, 0.1));
	stroma(iris->inner, inner < 0 ? 0 : inner, green + range(rng, 0, 0.8), bright * range(rng, 0.8, 1.5));
	stroma(iris->gap, brown + range(rng, 0.1, 0.5), green, bright * range(rng, 0.3, 0.7));
}

struct iris iris_make(struct rng *rng, bool test)
{
	struct iris s = { .family = test && rng_below(rng, 2) ? IRIS_BUNDLES : rng_below(rng, 25) ? rng_below(rng, IRIS_PRINTED) : IRIS_PRINTED };
	s.fine = field_of(s.family == IRIS_CRYPTS ? FIELD_CELL : rng_below(rng, 2) ? FIELD_SMOOTH : FIELD_RIDGE, rng_below(rng, FIELD_SEEDS), test);
	s.coarse = field_of(FIELD_SMOOTH, rng_below(rng, FIELD_SEEDS), test);
	colours(&s, rng);
	if (s.family == IRIS_PRINTED)
		for (int c = 0; c < 3; c++) {
			s.outer[c] = range(rng, 0.02, 0.8);
			s.inner[c] = range(rng, 0.02, 0.8);
			s.gap[c] = range(rng, 0.01, 0.3);
		}
	s.contrast = s.family == IRIS_PLAIN ? range(rng, 0, 0.4) : range(rng, 0.4, 1.3);
	s.fibres = (float)(1 + rng_below(rng, 4));
	s.warp = range(rng, 0, 25);
	s.at[0] = range(rng, 0, 256);
	s.at[1] = range(rng, 0, 256);
	s.collarette = range(rng, 0.15, 0.5);
	s.wobble = range(rng, 0.05, 0.35);
	s.ring = rng_below(rng, 3) ? range(rng, 0.1, 0.85) : 0;
	s.ring_width = range(rng, 0.05, 0.22);
	s.n_freckles = rng_below(rng, 3) ? 0 : rng_below(rng, FRECKLES_MAX);
	for (int i = 0; i < s.n_freckles; i++) {
		s.freckle[i][0] = range(rng, 0, 1);
		s.freckle[i][1] = range(rng, 0, 6.2831853);
		s.freckle[i][2] = range(rng, 0.03, 0.16);
		s.freckle[i][3] = range(rng, 0.3, 0.95);
	}
	return s;
}

/* 0..1, high on fibres, low in the gaps. turn: the angle in texels, whose period is the texture's. */
static float pattern(const struct iris *s, float share, float angle, float turn)
{
	const float sway = s->warp * (field_at(s->coarse, turn * 2, s->at[1] + 40 * share) - 0.5F);
	switch (s->family) {
	case IRIS_CRYPTS:
		return 0.6F * field_at(s->fine, turn * 3 + sway, s->at[1] + 90 * share) + 0.4F * field_at(s->coarse, turn * 8, s->at[0] + 25 * share);
	case IRIS_FURROWS: {
		const float rings = 0.5F + 0.5F * cosf(share * 6.2831853F * (2 + s->fibres) + 4 * field_at(s->coarse, turn * 3, s->at[0]));
		return 0.35F * rings + 0.65F * field_at(s->fine, turn * 2 + sway, s->at[1] + 60 * share);
	}
	case IRIS_BUNDLES: {
		const float wave = 0.5F + 0.25F * cosf(angle * (24 + 9 * s->fibres) + 7 * share) + 0.25F * cosf(angle * (17 + 6 * s->fibres) - 9 * share + sway);
		return 0.7F * wave + 0.3F * field_at(s->coarse, turn * 5, s->at[0] + 80 * share);
	}
	case IRIS_PRINTED: {
		// Checks, along the axes or round the pupil: what lenses and test eyes bear.
		const float r = 0.3F + 0.7F * share, n = 3 * s->fibres;
		const float a = s->warp > 12 ? n * 2 * angle / 6.2831853F : n * r * cosf(angle), b = s->warp > 12 ? n * share : n * r * sinf(angle);
		return ((int)floorf(a) + (int)floorf(b)) & 1 ? 1 : 0;
	}
	default:
		return 0.65F * field_at(s->fine, turn * (2 + s->fibres) + sway, s->at[1] + 14 * share)
		       + 0.35F * field_at(s->coarse, turn * 9 + sway, s->at[0] + 22 * share);
	}
}

void iris_albedo(float out[3], const struct iris *s, float share, float angle)
{
	const float turn = (angle / 6.2831853F + 1) * FIELD_SIDE;
	const float edge = s->collarette * (1 + s->wobble * 4 * (field_at(s->coarse, turn * 4, s->at[0]) - 0.5F));
	float in = (edge - share) / 0.12F + 0.5F;
	in = in < 0 ? 0 : in > 1 ? 1 : in;
	float on = 0.5F + s->contrast * 2.2F * (pattern(s, share, angle, turn) - 0.5F);
	on = on < 0 ? 0 : on > 1 ? 1 : on;
	float dark = 1 - s->ring / (1 + expf((1 - s->ring_width - share) / (0.35F * s->ring_width)));
	dark *= 1 - 0.75F * expf(-share / 0.03F);
	for (int i = 0; i < s->n_freckles; i++) {
		const float *f = s->freckle[i], dr = share - f[0], da = (angle - f[1]) * (0.4F + 0.6F * share), d = dr * dr + da * da;
		if (d < f[2] * f[2])
			dark *= 1 - f[3] * (1 - d / (f[2] * f[2]));
	}
	for (int c = 0; c < 3; c++) {
		const float base = s->outer[c] + in * (s->inner[c] - s->outer[c]);
		out[c] = dark * (s->gap[c] + on * (base * 1.25F - s->gap[c]));
	}
}
