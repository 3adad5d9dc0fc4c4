#include "other.h"

#include "field.h"

struct thing {
	float at[2], radius, squash, colour[4][3], turn, light[2];
	int count;
	const struct field *skin;
};

static void colour(float rgb[3], struct rng *rng)
{
	const float level = range_of(rng, 0.02, 0.9);
	for (int c = 0; c < 3; c++)
		rgb[c] = level * range_of(rng, 0.4, 1);
}

static void ball(float out[3], const struct thing *t, float x, float y, float r)
{
	const float z = sqrtf(fmaxf(1 - r * r, 0)), lit = fmaxf(x * t->light[0] + y * t->light[1] + 0.7F * z, 0) + 0.15F;
	const float spot = smooth_step(x * t->light[0] + y * t->light[1] + 0.75F * z, 0.93F, 0.97F);
	const int stripe = t->count > 4 && fabsf(y + 0.2F * z) < 0.25F;
	for (int c = 0; c < 3; c++)
		out[c] = t->colour[stripe][c] * lit * (0.7F + 0.6F * field_at(t->skin, 60 * x, 60 * y)) + spot;
}

static void wheel(float out[3], const struct thing *t, float r, float angle)
{
	const float spoke = cosf((float)t->count * angle + t->turn);
	const int part = r > 0.75F ? 0 : r > 0.68F ? 1 : r < 0.15F ? 2 : spoke > 0.3F ? 1 : 3;
	for (int c = 0; c < 3; c++)
		out[c] = t->colour[part][c] * (part == 0 ? 0.15F : 1);
}

static void button(float out[3], const struct thing *t, float x, float y, float r)
{
	const int holes = t->count > 5 ? 4 : 2;
	float level = r > 0.8F ? 1.2F : 0.85F + 0.2F * x;
	for (int h = 0; h < holes; h++) {
		const float a = t->turn + 6.2831853F * (float)h / (float)holes, dx = x - 0.28F * cosf(a), dy = y - 0.28F * sinf(a);
		level *= smooth_step(dx * dx + dy * dy, 0.006F, 0.014F) * 0.95F + 0.05F;
	}
	for (int c = 0; c < 3; c++)
		out[c] = t->colour[0][c] * level;
}

/* Flat rings of paint: a target, or the eye of a doll with a hard outline. */
static void rings(float out[3], const struct thing *t, float x, float y, float r, bool doll)
{
	int part = (int)(r * (float)t->count) % 4;
	if (doll)
		part = r > 0.93F ? 3 : r > 0.5F ? 1 : r > 0.25F ? 2 : 3;
	for (int c = 0; c < 3; c++)
		out[c] = doll && part == 3 ? 0.01F : t->colour[part][c];
	if (doll && (x + 0.2F) * (x + 0.2F) + (y + 0.2F) * (y + 0.2F) < 0.012F)
		out[0] = out[1] = out[2] = 0.9F;
}

static void text(float out[3], const struct thing *t, float x, float y)
{
	const float row = y * (float)t->count, line = row - floorf(row);
	const float ink = field_at(t->skin, 90 * x + 37 * floorf(row), 14 * line);
	const bool on = line > 0.3F && line < 0.8F && ink > 0.5F && field_at(t->skin, 14 * x, 9 * floorf(row)) > 0.42F;
	for (int c = 0; c < 3; c++)
		out[c] = on ? 0.2F * t->colour[1][c] : 0.3F + 0.7F * t->colour[0][c];
}

static struct thing thing_make(const struct canvas *c, struct rng *rng, bool test)
{
	struct thing t = { .radius = (float)c->width * 0.04F * expf(range_of(rng, 0, 2.3)), .squash = rng_below(rng, 2) ? 1 : range_of(rng, 0.5, 1) };
	t.at[0] = range_of(rng, 0, c->width);
	t.at[1] = range_of(rng, 0, c->height);
	for (int i = 0; i < 4; i++)
		colour(t.colour[i], rng);
	t.turn = range_of(rng, 0, 6.28);
	t.light[0] = range_of(rng, -0.6, 0.6);
	t.light[1] = range_of(rng, -0.7, 0.3);
	t.count = 3 + rng_below(rng, 9);
	t.skin = field_of(rng_below(rng, FIELD_KINDS), rng_below(rng, FIELD_SEEDS), test);
	return t;
}

static void thing_draw(struct canvas *canvas, const struct thing *t, enum other_kind kind)
{
	const float co = cosf(t->turn), si = sinf(t->turn);
	for (int j = 0; j < canvas->height; j++)
		for (int i = 0; i < canvas->width; i++) {
			const float dx = ((float)i + 0.5F - t->at[0]) / t->radius, dy = ((float)j + 0.5F - t->at[1]) / t->radius;
			const float x = co * dx + si * dy, y = (co * dy - si * dx) / t->squash, r = hypotf(x, y);
			const float cover = fminf(fmaxf(0.5F + (1 - r) * t->radius, 0), 1);
			if (cover == 0 && kind != OTHER_TEXT)
				continue;
			float rgb[3];
			switch (kind) {
			case OTHER_BALL: ball(rgb, t, x, y, r); break;
			case OTHER_WHEEL: wheel(rgb, t, r, atan2f(y, x)); break;
			case OTHER_BUTTON: button(rgb, t, x, y, r); break;
			case OTHER_TEXT: text(rgb, t, 0.4F * x, 0.4F * y); break;
			default: rings(rgb, t, x, y, r, kind == OTHER_DOLL);
			}
			float *to = canvas->rgb + 3 * ((long)j * canvas->width + i);
			for (int c = 0; c < 3; c++)
				to[c] += (kind == OTHER_TEXT ? 1 : cover) * (rgb[c] - to[c]);
		}
}

struct shape {
	int kind;  // 0 disc, 1 box, 2 strip, 3 triangle
	float at[2], half[2], turn, soft, colour[2][3], light[2], stripes, grain;
	const struct field *skin;
};

static struct shape shape_make(const struct canvas *c, struct rng *rng, bool test)
{
	struct shape s = { .kind = rng_below(rng, 4), .turn = range_of(rng, 0, 6.28) };
	const float size = (float)c->width * 0.03F * expf(range_of(rng, 0, 2.8));
	s.at[0] = range_of(rng, 0, c->width);
	s.at[1] = range_of(rng, 0, c->height);
	s.half[0] = size;
	s.half[1] = s.kind == 2 ? 0.15F * size : size * range_of(rng, 0.3, 1);
	s.soft = rng_below(rng, 3) ? 0.7F : range_of(rng, 1, 12);
	colour(s.colour[0], rng);
	colour(s.colour[1], rng);
	s.light[0] = range_of(rng, -0.7, 0.7);
	s.light[1] = range_of(rng, -0.7, 0.7);
	s.stripes = rng_below(rng, 4) ? 0 : range_of(rng, 3, 40);
	s.grain = range_of(rng, 0, 1.2);
	s.skin = field_of(rng_below(rng, FIELD_KINDS), rng_below(rng, FIELD_SEEDS), test);
	return s;
}

static void shape_draw(struct canvas *canvas, const struct shape *s, const bool *where)
{
	const float co = cosf(s->turn), si = sinf(s->turn), reach = s->half[0] * 1.5F + s->soft;
	const int x0 = (int)fmaxf(s->at[0] - reach, 0), x1 = (int)fminf(s->at[0] + reach, (float)canvas->width - 1);
	const int y0 = (int)fmaxf(s->at[1] - reach, 0), y1 = (int)fminf(s->at[1] + reach, (float)canvas->height - 1);
	for (int j = y0; j <= y1; j++)
		for (int i = x0; i <= x1; i++) {
			if (where && !where[j * canvas->width + i])
				continue;
			const float dx = (float)i + 0.5F - s->at[0], dy = (float)j + 0.5F - s->at[1], x = co * dx + si * dy, y = co * dy - si * dx;
			const float a = x / s->half[0], b = y / s->half[1];
			const float in = s->kind == 0 ? 1 - hypotf(a, b) : s->kind == 3 ? 0.7F - fabsf(a) - fmaxf(b, -0.5F) * 0.7F - fmaxf(-b - 0.5F, 0) * 3 : 1 - fmaxf(fabsf(a), fabsf(b));
			const float cover = smooth_step(in * s->half[1], -s->soft, s->soft);
			if (cover <= 0)
				continue;
			const float stripe = s->stripes > 0 ? 0.5F + 0.5F * sinf(s->stripes * a) : 0;
			const float lit = fmaxf(1 + s->light[0] * a + s->light[1] * b, 0) * (1 + s->grain * (field_at(s->skin, 2 * x, 2 * y) - 0.5F));
			float *to = canvas->rgb + 3 * ((long)j * canvas->width + i);
			for (int c = 0; c < 3; c++)
				to[c] += cover * (lit * (s->colour[0][c] + stripe * (s->colour[1][c] - s->colour[0][c])) - to[c]);
		}
}

void other_clutter(struct canvas *canvas, const bool *where, struct rng *rng, bool test)
{
	const int n = 2 + rng_below(rng, 24);
	for (int k = 0; k < n; k++) {
		const struct shape s = shape_make(canvas, rng, test);
		shape_draw(canvas, &s, where);
	}
}

void other_draw(struct canvas *canvas, enum other_kind kind, struct rng *rng, bool test)
{
	const struct field *a = field_of(rng_below(rng, FIELD_KINDS), rng_below(rng, FIELD_SEEDS), test);
	const struct field *b = field_of(rng_below(rng, FIELD_KINDS), rng_below(rng, FIELD_SEEDS), test);
	const float scale = expf(range_of(rng, -2, 1.5)), turn = range_of(rng, 0, 6.28), co = scale * cosf(turn), si = scale * sinf(turn);
	float two[2][3];
	colour(two[0], rng);
	colour(two[1], rng);
	const float busy = rng_below(rng, 3) ? 1 : range_of(rng, 0, 0.2);
	for (int j = 0; j < canvas->height; j++)
		for (int i = 0; i < canvas->width; i++) {
			const float x = co * (float)i + si * (float)j, y = co * (float)j - si * (float)i;
			const float p = field_at(a, x, y), slow = (float)j / (float)canvas->height;
			const float q = slow + busy * (smooth_step(field_at(b, 0.4F * x, 0.4F * y), 0.4F, 0.6F) - slow);
			for (int c = 0; c < 3; c++)
				canvas->rgb[3 * ((long)j * canvas->width + i) + c] = (two[0][c] + q * (two[1][c] - two[0][c])) * (0.6F + busy * (1.5F * p * p - 0.4F));
		}
	if (kind == OTHER_CLUTTER || !rng_below(rng, 3))
		other_clutter(canvas, 0, rng, test);
	const int n = kind == OTHER_TEXTURE || kind == OTHER_CLUTTER ? 0 : kind == OTHER_TEXT ? 1 : 1 + rng_below(rng, 4);
	for (int k = 0; k < n; k++) {
		const struct thing t = thing_make(canvas, rng, test);
		thing_draw(canvas, &t, kind);
	}
}
