#include "lids.h"

static void hair_colour(float rgb[3], struct rng *rng)
{
	const float dark = range_of(rng, 0.005, 1);
	const float level = 0.008F + 0.25F * dark * dark * dark, red = range_of(rng, 0, 0.6);
	rgb[0] = level * (1 + red);
	rgb[1] = level;
	rgb[2] = level * (1 - 0.8F * red);
}

/* Height of a lid at t = 0 inner .. 1 outer corner, 1 at its peak. */
static float arch(float t, float a, float b, bool round)
{
	if (t <= 0 || t >= 1)
		return 0;
	if (round)
		return powf(sinf(3.14159265F * powf(t, 0.6F + 0.5F * a)), 0.5F + 0.6F * b);
	const float peak = a / (a + b);
	return powf(t / peak, a) * powf((1 - t) / (1 - peak), b);
}

static void shape(struct lids *l, struct rng *rng, bool test, float openness, float gaze_y)
{
	const bool round = test && rng_below(rng, 2);
	l->inner[0] = -range_of(rng, 12.5, 16);
	l->inner[1] = range_of(rng, -2.5, 0.5);
	l->outer[0] = range_of(rng, 11.5, 16);
	l->outer[1] = l->inner[1] + range_of(rng, -1.5, 4.5);
	const float up = openness * range_of(rng, 5, 8) + 5.5F * gaze_y, down = openness * range_of(rng, 4.2, 6.5) - 2.5F * gaze_y;
	const float gap = fmaxf(up + down, 0), mid = openness < 0.05F ? -4 : 0.5F * (up - down);
	const float a[2] = { range_of(rng, 0.6, 1.15), range_of(rng, 0.75, 1.4) }, b[2] = { range_of(rng, 0.5, 0.95), range_of(rng, 0.5, 0.9) };
	const float fold = range_of(rng, 0.3, 9), follow = range_of(rng, 0.4, 1), slope = range_of(rng, -2.5, 2.5);
	const float hood = rng_below(rng, 4) ? 0 : range_of(rng, 0, 3);
	l->open = openness < 0.05F ? 0 : gap;
	for (int i = 0; i < LID_SAMPLES; i++) {
		const float t = (float)i / (LID_SAMPLES - 1), base = l->inner[1] + t * (l->outer[1] - l->inner[1]);
		l->upper[i] = base + (mid + 0.5F * l->open) * arch(t, a[0], b[0], round);
		l->lower[i] = base + (mid - 0.5F * l->open) * arch(t, a[1], b[1], round);
		if (l->upper[i] < l->lower[i])
			l->upper[i] = l->lower[i] = 0.5F * (l->upper[i] + l->lower[i]);
		const float top = base + (fmaxf(mid + 0.5F * gap, 2) * follow + (1 - follow) * 7 + fold) * powf(arch(t, 0.5F, 0.5F, false), 0.8F);
		l->crease[i] = fmaxf(top + slope * (t - 0.5F), l->upper[i] + 0.2F) - hood * (t < 0.35F ? 1 - t / 0.35F : 0);
	}
}

static void make_up(struct lids *l, struct rng *rng)
{
	l->liner = rng_below(rng, 4) ? 0 : range_of(rng, 0.3, 1);
	l->liner_wide = range_of(rng, 0.3, 2);
	l->shadow = rng_below(rng, 4) ? 0 : range_of(rng, 0.1, 0.8);
	for (int c = 0; c < 3; c++)
		l->shadow_rgb[c] = range_of(rng, 0.02, 0.6);
}

static void hairs(struct lids *l, struct rng *rng, bool test)
{
	hair_colour(l->brow_rgb, rng);
	hair_colour(l->lash_rgb, rng);
	for (int c = 0; c < 3; c++)
		l->lash_rgb[c] *= 0.5F;
	l->style = test && rng_below(rng, 2) ? LASH_CLUMPED : rng_below(rng, LASH_CLUMPED);
	if (l->style == LASH_NONE && rng_below(rng, 2))
		l->style = LASH_FAN;
	l->lashes[0] = l->style == LASH_NONE ? 0 : l->style == LASH_SPARSE ? 8 + rng_below(rng, 30) : 50 + rng_below(rng, 90);
	l->lashes[1] = rng_below(rng, 4) ? l->lashes[0] / (2 + rng_below(rng, 3)) : 0;
	l->lash_length[0] = range_of(rng, 4, 11);
	l->lash_length[1] = range_of(rng, 2, 6);
	l->lash_wide = rng_below(rng, 3) ? range_of(rng, 0.07, 0.16) : range_of(rng, 0.16, 0.4);
	l->lash_curl = l->style == LASH_STRAIGHT ? range_of(rng, -0.9, 0.1) : range_of(rng, -0.2, 1);
	l->brow_hairs = rng_below(rng, 8) ? 60 + rng_below(rng, 300) : 0;
	l->brow_at = range_of(rng, 13, 24);
	l->brow_arch = range_of(rng, 0, 6);
	l->brow_thick = range_of(rng, 2.5, 10);
	l->brow_tilt = range_of(rng, -3, 4);
	l->brow_wide = range_of(rng, 0.08, 0.3);
	l->brow_tone = range_of(rng, 0, 0.5);
}

struct lids lids_make(struct rng *rng, bool test, float openness, float gaze_y)
{
	struct lids l = { 0 };
	shape(&l, rng, test, openness, gaze_y);
	l.crease_depth = rng_below(rng, 5) ? range_of(rng, 0.1, 1.6) : 0;
	l.crease_wide = range_of(rng, 0.3, 1.3);
	l.bag = range_of(rng, 0, 1.5);
	l.rim = range_of(rng, 0.4, 1.8);
	l.caruncle = range_of(rng, 1.5, 5);
	l.shade = (struct lid_shade){ 0.6F, 1.3F, 0.3F, 0.8F, { 0.35F, 0.35F }, { 3, 3 }, 0, 1, 1 };
	make_up(&l, rng);
	hairs(&l, rng, test);
	return l;
}

struct lid_heights lids_at(const struct lids *l, float x)
{
	float t = (x - l->inner[0]) / (l->outer[0] - l->inner[0]) * (LID_SAMPLES - 1);
	t = t < 0 ? 0 : t > LID_SAMPLES - 1.001F ? LID_SAMPLES - 1.001F : t;
	const int i = (int)t;
	const float f = t - (float)i;
	return (struct lid_heights){ l->upper[i] + f * (l->upper[i + 1] - l->upper[i]), l->lower[i] + f * (l->lower[i + 1] - l->lower[i]),
		l->crease[i] + f * (l->crease[i + 1] - l->crease[i]) };
}

static void hair(struct canvas *canvas, const struct eye_frame *f, const float p[3][2], float width, const float rgb[3], const float light[3],
                 float level, float opacity)
{
	float q[3][2], lit[3];
	for (int i = 0; i < 3; i++) {
		q[i][0] = f->at[0] + f->side * f->narrow * p[i][0];
		q[i][1] = f->at[1] + p[i][1];
	}
	for (int c = 0; c < 3; c++)
		lit[c] = level * rgb[c] * light[c];
	canvas_hair(canvas, (const float(*)[2])q, width, lit, opacity);
}

static void lash_row(struct canvas *canvas, const struct lids *l, const struct eye_frame *f, struct rng *rng, const float light[3], bool lower)
{
	const int n = l->lashes[lower];
	const float out = lower ? -1 : 1, curl = lower ? 1 : l->lash_curl, clump = range_of(rng, 1.5, 4);
	for (int i = 0; i < n; i++) {
		const float t = 0.12F + 0.86F * ((float)i + range_of(rng, 0, 1)) / (float)n, x = l->inner[0] + t * (l->outer[0] - l->inner[0]);
		const struct lid_heights h = lids_at(l, x);
		const float length = l->lash_length[lower] * range_of(rng, 0.5, 1.1) * (0.5F + t) * 0.8F;
		float fan = length * (1.1F * (t - 0.42F) + (float)(0.12 * rng_normal(rng)));
		if (l->style == LASH_CLUMPED)
			fan += 0.7F * (clump * roundf(x / clump) - x);
		const float y = (lower ? h.lower - 0.4F * l->rim : h.upper) + range_of(rng, -0.2, 0.3);
		const float p[3][2] = { { x, y }, { x + 0.3F * fan, y + out * length * (0.15F + 0.35F * curl * range_of(rng, 0, 1)) - (lower ? 0 : 0.25F * length) },
			{ x + fan, y + out * length * 0.8F * curl } };
		hair(canvas, f, p, l->lash_wide * range_of(rng, 0.6, 1.3), l->lash_rgb, light, range_of(rng, 0.5, 1.3), 0.95F);
	}
}

void lids_draw_lashes(struct canvas *canvas, const struct lids *l, const struct eye_frame *f, struct rng *rng, const float light[3])
{
	lash_row(canvas, l, f, rng, light, false);
	lash_row(canvas, l, f, rng, light, true);
}

void lids_draw_brow(struct canvas *canvas, const struct lids *l, const struct eye_frame *f, struct rng *rng, const float light[3])
{
	for (int i = 0; i < l->brow_hairs; i++) {
		const float t = range_of(rng, 0, 1), x = -14 + 38 * t, thick = l->brow_thick * (t < 0.7F ? 1 : 1 - (t - 0.7F) / 0.35F);
		const float y = l->brow_at + l->brow_arch * sinf(3.0F * t * t) + l->brow_tilt * t + thick * range_of(rng, -0.5, 0.5);
		const float length = range_of(rng, 3, 8), turn = (float)(1.3 - 1.3 * t + 0.25 * rng_normal(rng));
		const float dx = length * cosf(turn), dy = length * sinf(turn) * (t > 0.6F ? 0.5F : 1);
		const float p[3][2] = { { x, y }, { x + 0.5F * dx, y + 0.6F * dy }, { x + dx, y + 0.8F * dy } };
		hair(canvas, f, p, l->brow_wide, l->brow_rgb, light, range_of(rng, 0.6, 1.5), 0.85F);
	}
}
