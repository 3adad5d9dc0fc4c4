#include "face.h"

static void skin_colour(struct face *f, struct rng *rng)
{
	f->melanin = rng_below(rng, 2) ? range_of(rng, 0.02, 0.45) : range_of(rng, 0.3, 1.6);
	f->blood = range_of(rng, 0.5, 1.5);
	f->oil = range_of(rng, 0, 0.25);
	f->rough = range_of(rng, 0, 0.09);
	f->wrinkle = rng_below(rng, 2) ? range_of(rng, 0, 0.1) : range_of(rng, 0.1, 0.45);
	f->spots = range_of(rng, 0, 0.6);
	f->ring = range_of(rng, 0, 0.8);
}

static void body(struct face *f, struct rng *rng, bool test)
{
	f->neck = f->half[0] * range_of(rng, 0.55, 0.85);
	f->shoulder = f->half_at - f->half[1] - range_of(rng, 15, 60);
	f->slope = range_of(rng, 0.15, 0.7);
	f->body_wide = range_of(rng, 150, 260);
	f->hair_down = rng_below(rng, 3) ? -60 : -range_of(rng, 60, 300);
	f->bare_body = !rng_below(rng, 4);
	const float level = range_of(rng, 0.02, 0.8);
	for (int c = 0; c < 3; c++)
		f->cloth[c] = level * range_of(rng, 0.3, 1);
	f->hair_out = rng_below(rng, 2) ? 1.45F : range_of(rng, 1.1, 2.8);
	f->hair_curl = rng_below(rng, 2) ? 0 : range_of(rng, 0.3, 1);
	f->curls = field_of(rng_below(rng, FIELD_KINDS), rng_below(rng, FIELD_SEEDS), test);
	f->weave = field_of(rng_below(rng, FIELD_KINDS), rng_below(rng, FIELD_SEEDS), test);
}

struct face drawn_face_make(struct rng *rng, bool test)
{
	struct face f = { 0 };
	skin_colour(&f, rng);
	const float yaw = rng_below(rng, 2) ? 0 : range_of(rng, -0.7, 0.7);
	f.narrow = cosf(yaw);
	f.nose_shift = 18 * sinf(yaw);
	f.depth = range_of(rng, 0.6, 1.4);
	f.nose_wide = range_of(rng, 7, 12);
	f.nose_length = range_of(rng, 36, 52);
	f.socket = range_of(rng, 1, 7);
	f.half[0] = range_of(rng, 62, 80);
	f.half[1] = range_of(rng, 88, 115);
	f.half_at = -range_of(rng, 15, 30);
	f.mouth_at = -f.nose_length - range_of(rng, 18, 28);
	f.mouth_wide = range_of(rng, 20, 32);
	f.mouth_open = rng_below(rng, 3) ? 0.6F : range_of(rng, 1, 9);
	for (int c = 0; c < 3; c++)
		f.lip[c] = range_of(rng, 0.1, 0.5) * (c ? 0.5F : 1);
	f.hairline = range_of(rng, 40, 85);
	const float dark = range_of(rng, 0, 1), red = range_of(rng, 0, 0.6);
	for (int c = 0; c < 3; c++)
		f.hair[c] = (0.008F + 0.35F * dark * dark * dark) * (c == 0 ? 1 + red : c == 1 ? 1 : 1 - 0.7F * red);
	f.beard = rng_below(rng, 4) ? 0 : range_of(rng, 0.2, 0.9);
	f.at[0] = range_of(rng, 0, 256);
	f.at[1] = range_of(rng, 0, 256);
	f.turn = range_of(rng, -0.4, 0.4);
	f.fine = field_of(FIELD_FINE, rng_below(rng, FIELD_SEEDS), test);
	f.lines = field_of(FIELD_LINES, rng_below(rng, FIELD_SEEDS), test);
	f.blotch = field_of(FIELD_SMOOTH, rng_below(rng, FIELD_SEEDS), test);
	f.strands = field_of(FIELD_LINES, rng_below(rng, FIELD_SEEDS), test);
	f.back_scale = range_of(rng, 0.2, 3);
	f.back_busy = rng_below(rng, 3) ? 1 : range_of(rng, 0, 0.2);
	for (int i = 0; i < 2; i++) {
		f.behind[i] = field_of(rng_below(rng, FIELD_KINDS), rng_below(rng, FIELD_SEEDS), test);
		for (int c = 0; c < 3; c++)
			f.back[i][c] = range_of(rng, 0.01, 0.9);
	}
	body(&f, rng, test);
	return f;
}

static float bump(float x, float y, float a, float b)
{
	const float d = x * x / (a * a) + y * y / (b * b);
	return d > 9 ? 0 : expf(-d);
}

/* Lids, folds and bags of one eye; x, y in its frame. */
static void around_eye(struct skin_point *out, const struct face *f, const struct lids *l, float x, float y)
{
	const struct lid_heights h = lids_at(l, x);
	const float inside = smooth_step(x, l->inner[0] - 3, l->inner[0] + 3) * (1 - smooth_step(x, l->outer[0] - 2, l->outer[0] + 5));
	out->height += 4.5F * bump(x, y, 13, 11) - f->socket * bump(x + 14, y - 5, 7, 8) - 0.5F * f->socket * bump(x, y - 11, 20, 5);
	const float from_crease = (y - h.crease) / l->crease_wide;
	const float line = from_crease * from_crease < 9 ? expf(-from_crease * from_crease) * inside : 0;
	out->height -= l->crease_depth * line;
	if (y > h.crease)
		out->height += 0.7F * l->crease_depth * inside * expf(-(y - h.crease) / 4);
	out->open *= 1 - 0.45F * fminf(l->crease_depth, 1) * line;
	out->height += l->bag * (bump(x, y - h.lower + 9, 14, 3.5F) - 0.8F * bump(x, y - h.lower + 14, 15, 2.5F));
	out->open *= 1 - 0.25F * bump(x + 15, y - 3, 8, 9);
	const float over = y - h.upper, under = h.lower - y;
	if (under > 0 && under < 3 * l->rim) {
		const float rim = inside * (1 - smooth_step(under, 0.7F * l->rim, 1.3F * l->rim));
		out->height -= 0.6F * rim;
		out->albedo[0] += rim * (0.5F * out->albedo[0] + 0.18F - out->albedo[0]) * 0.6F;
		out->albedo[1] *= 1 - 0.15F * rim;
	}
	if (over > 0 && over < 2)
		out->open *= 1 - 0.4F * (1 - over / 2) * inside;
	if (l->shadow > 0 && over > -1) {
		const float s = l->shadow * inside * (1 - smooth_step(over, 4, 12));
		for (int c = 0; c < 3; c++)
			out->albedo[c] += s * (l->shadow_rgb[c] - out->albedo[c]);
	}
	const float edge = over > 0 ? over : under * 1.6F;
	if (l->liner > 0 && edge > 0) {
		const float s = l->liner * inside * (1 - smooth_step(edge, 0.6F * l->liner_wide, l->liner_wide));
		for (int c = 0; c < 3; c++)
			out->albedo[c] += s * (0.015F - out->albedo[c]);
	}
	const float t = (x + 14) / 38;
	if (t > 0 && t < 1.1F && l->brow_hairs) {
		const float off = (y - l->brow_at - l->brow_arch * sinf(3.0F * t * t) - l->brow_tilt * t - 2) / l->brow_thick;
		const float s = l->brow_tone * smooth_step(t, 0, 0.15F) * (1 - smooth_step(t, 0.8F, 1.1F)) * expf(-3 * off * off);
		for (int c = 0; c < 3; c++)
			out->albedo[c] += s * (l->brow_rgb[c] - out->albedo[c]);
	}
}

static void lower_face(struct skin_point *out, const struct face *f, float u, float v)
{
	const float nu = u - f->nose_shift * smooth_step(-v, -5, f->nose_length), along = smooth_step(v, -f->nose_length - 4, -f->nose_length + 6);
	const float high = 3 + 15 * smooth_step(-v, -12, f->nose_length);
	out->height += f->depth * along * high * bump(nu, 0, f->nose_wide * (0.6F + 0.5F * smooth_step(-v, 0, f->nose_length)), 1);
	const float nostril = bump(fabsf(nu) - 0.65F * f->nose_wide, v + f->nose_length - 1, 3.2F, 2);
	out->open *= 1 - 0.93F * fminf(1.6F * nostril, 1);
	const float mx = (u - 0.7F * f->nose_shift) / f->mouth_wide, my = v - f->mouth_at - 2 * mx * mx;
	if (fabsf(mx) < 1) {
		const float thick = 8 * (1 - mx * mx), lips = 1 - smooth_step(fabsf(my), 0.8F * thick, 1.1F * thick + 0.1F);
		for (int c = 0; c < 3; c++)
			out->albedo[c] += 0.7F * lips * (f->lip[c] - out->albedo[c]);
		out->open *= 1 - 0.85F * (1 - smooth_step(fabsf(my), 0.5F * f->mouth_open, f->mouth_open + 0.8F)) * (1 - mx * mx);
		out->height += 2 * lips;
	}
	if (f->beard > 0) {
		const float s = f->beard * smooth_step(-v, f->nose_length - 5, f->nose_length + 12) * field_at(f->fine, 5 * u, 5 * v);
		for (int c = 0; c < 3; c++)
			out->albedo[c] += s * (f->hair[c] - out->albedo[c]);
	}
}

static void behind(struct skin_point *out, const struct face *f, float u, float v)
{
	const float a = field_at(f->behind[0], f->at[0] + f->back_scale * u, f->at[1] + f->back_scale * v);
	const float b = field_at(f->behind[1], f->at[1] + 0.3F * f->back_scale * v, f->at[0] - 0.3F * f->back_scale * u);
	const float mix = smooth_step(b, 0.42F, 0.58F);
	// A plain wall or a sky: one colour that turns into the other.
	const float slow = smooth_step(v, -250, 150), from = slow + f->back_busy * (mix - slow);
	for (int c = 0; c < 3; c++)
		out->albedo[c] = (f->back[0][c] + from * (f->back[1][c] - f->back[0][c])) * (0.9F + f->back_busy * (1.2F * a - 0.6F));
}

/* Colour of skin and its fine relief. */
static void skin(struct skin_point *out, const struct face *f, float u, float v)
{
	const float blotch = field_at(f->blotch, f->at[0] + 1.5F * u, f->at[1] + 1.5F * v), fine = field_at(f->fine, f->at[0] + 6 * u, f->at[1] + 6 * v);
	float melanin = f->melanin * (1 + 0.5F * (blotch - 0.5F));
	const float spot = field_at(f->blotch, 5 * v, 5 * u);
	melanin += f->spots * 1.5F * fmaxf(spot - 0.72F, 0);
	out->height += f->rough * (fine - 0.5F);
	if (f->wrinkle > 0.02F)
		out->height -= f->wrinkle * field_at(f->lines, f->at[0] + 2 * u + 2 * f->turn * v, f->at[1] + 3 * v - 2 * f->turn * u);
	static const float sigma[3] = { 1, 1.6F, 2.4F }, red[3] = { 0.1F, 0.5F, 0.45F }, base[3] = { 0.15F, 0.25F, 0.35F };
	for (int e = 0; e < 2; e++)
		melanin += f->ring * 0.3F * bump(u - f->frame[e].at[0] / f->narrow, v - f->frame[e].at[1] + 4, 17, 13);
	for (int c = 0; c < 3; c++)
		out->albedo[c] = expf(-sigma[c] * melanin - red[c] * f->blood * (0.7F + 0.6F * blotch) - base[c]);
}

/* Neck and shoulders, in clothes or bare. */
static bool below_face(struct skin_point *out, const struct face *f, float u, float v)
{
	const float side = fabsf(u), line = f->shoulder - f->slope * fmaxf(side - f->neck, 0);
	const bool on_body = v < line && side < f->body_wide, on_neck = !on_body && side < f->neck && v < f->half_at;
	if (!on_body && !on_neck)
		return false;
	skin(out, f, u, v);
	out->height -= on_neck ? 0.6F * u * u / f->neck : 0.25F * side;
	out->open = on_neck ? 1 - 0.5F * smooth_step(v, f->shoulder, f->half_at - f->half[1]) : 1;
	if (on_body && (!f->bare_body || v < line - 80))
		for (int c = 0; c < 3; c++)
			out->albedo[c] = f->cloth[c] * (0.6F + 0.8F * field_at(f->weave, 1.3F * u, 1.3F * v));
	return true;
}

bool drawn_face_at(struct skin_point *out, const struct face *f, float u, float v)
{
	*out = (struct skin_point){ .open = 1 };
	const float a = u / f->half[0], b = (v - f->half_at) / f->half[1], r = a * a + b * b;
	const float straight = field_at(f->strands, 1.2F * v + 20 * a * a, 3.5F * u), curl = field_at(f->curls, 1.5F * u, 1.5F * v);
	const float strand = straight + f->hair_curl * (curl - straight), out_to = f->hair_out * (1 + 0.8F * f->hair_curl * (field_at(f->curls, 0.3F * u, 0.3F * v) - 0.5F));
	if (r > 1 || v > f->hairline + 12 * (strand - 0.5F)) {
		if ((r < out_to && v > -60) || (v <= -60 && v > f->hair_down && fabsf(u) < 1.25F * f->half[0] && (fabsf(u) > 0.6F * f->half[0] || v > f->half_at - f->half[1]))) {
			for (int c = 0; c < 3; c++)
				out->albedo[c] = f->hair[c] * (0.3F + 1.6F * strand * strand);
			return true;
		}
		if (below_face(out, f, u, v))
			return true;
		behind(out, f, u, v);
		return false;
	}
	out->height = 12 * (sqrtf(fmaxf(1.05F - r, 0.02F)) - 1) * 2 + 3 * f->depth * bump(0, v - 20, 1, 9);
	skin(out, f, u, v);
	lower_face(out, f, u, v);
	for (int e = 0; e < 2; e++) {
		const float x = (u - f->frame[e].at[0] / f->narrow) * f->frame[e].side, y = v - f->frame[e].at[1];
		if (x * x + y * y < 1100)
			around_eye(out, f, &f->lids[e], x, y);
	}
	return true;
}
