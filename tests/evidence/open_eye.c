#include "scene_impl.h"

#include "other.h"

static float luma(const float rgb[3])
{
	return 0.2126F * rgb[0] + 0.7152F * rgb[1] + 0.0722F * rgb[2];
}

/* What is mirrored is a reflection where it outshines what lies below it. */
static int label_of(const struct ball_point *p, float kept, const float white[3])
{
	const float m = luma(p->mirror);
	return m > 0.12F * luma(white) && m > 0.8F * luma(p->body) * kept ? EVIDENCE_REFLECTION : p->label;
}

/* What a pixel shows. */
static void note(struct canvas *c, long i, const struct ball_point *p, float kept, const float white[3])
{
	c->label[i] = (uint8_t)label_of(p, kept, white);
	c->mirror[i] = luma(p->mirror);
	c->body[i] = luma(p->body) * kept;
}

/* An eyeball without lids, before whatever is there: a prepared one, a prosthesis, a model. */
static void draw_bare(struct canvas *c, const struct set *s, int e)
{
	const struct eye_frame *f = &s->face.frame[e];
	for (int j = 0; j < c->height; j++)
		for (int i = 0; i < c->width; i++) {
			float uv[2];
			face_uv(uv, c, i, j);
			const float x = uv[0] - f->at[0], y = uv[1] - f->at[1];
			const float cover = fminf(fmaxf(0.5F + (s->ball[e].radius - hypotf(x, y)) / c->mm, 0), 1);
			if (cover <= 0)
				continue;
			struct ball_point p;
			ball_at(&p, &s->ball[e], &s->light, x, y);
			const float shade = light_shade(&s->light, uv[0], uv[1]);
			float *to = c->rgb + 3 * ((long)j * c->width + i);
			for (int k = 0; k < 3; k++)
				to[k] += cover * (p.body[k] * shade + p.mirror[k] - to[k]);
			if (cover > 0.5F)
				note(c, (long)j * c->width + i, &p, shade, s->white);
		}
}

static void behind_bare(struct canvas *c, const struct set *s, struct rng *rng, bool test)
{
	const int which = rng_below(rng, 4);
	if (which == 3) {
		other_draw(c, rng_below(rng, 2) ? OTHER_TEXTURE : OTHER_CLUTTER, rng, test);
		return;
	}
	const float level = which == 0 ? 0 : which == 1 ? range_of(rng, 0, 0.1) : range_of(rng, 0, 1);
	for (long i = 0; i < (long)c->width * c->height; i++)
		for (int k = 0; k < 3; k++)
			c->rgb[3 * i + k] = level * s->white[k] * (which == 2 ? s->face.back[0][k] : 1);
}

/* Share of the light that lids and lashes let through; the upper ones keep more away. In the nearer corner alone. */
static float let_through(const struct lid_shade *s, float above, float below, float inner, float outer)
{
	const int k = outer < inner;
	const float corner = fmaxf(k ? outer : inner, 0);
	return (1 - s->upper * expf(-above / s->upper_mm)) * (1 - s->lower * expf(-below / s->lower_mm)) * (1 - s->corner[k] * expf(-corner / s->corner_mm[k]))
	       * (1 - s->cast * smooth_step(s->cast_mm - above, -s->cast_soft, s->cast_soft));
}

/* One pixel of an open eye at (x, y) mm of its frame; d: distance inside of the lids, mm. */
static void eye_pixel(struct canvas *c, long i, const struct set *s, int e, float x, float y, float d, const struct lid_heights *h, float shade)
{
	const struct lids *l = &s->face.lids[e];
	struct ball_point p;
	ball_at(&p, &s->ball[e], &s->light, s->face.frame[e].side * x * s->face.narrow, y);
	const float caruncle = 1 - smooth_step(x, l->inner[0] + l->caruncle - 1, l->inner[0] + l->caruncle + 1);
	if (caruncle > 0) {
		const float lit = 0.8F * caruncle;
		for (int k = 0; k < 3; k++)
			p.body[k] += lit * (s->ball[e].canthus[k] * s->white[k] - p.body[k]);
		if (caruncle > 0.5F)
			p.label = EVIDENCE_SCLERA;
	}
	const float above = fmaxf(h->upper - y, 0), below = fmaxf(y - h->lower, 0);
	const float kept = shade * let_through(&l->shade, above, below, x - l->inner[0], l->outer[0] - x);
	const float hid = smooth_step(above, 0.1F, 1.2F);
	float rgb[3];
	for (int k = 0; k < 3; k++) {
		p.mirror[k] *= 0.25F + 0.75F * hid;
		rgb[k] = p.body[k] * kept + p.mirror[k] + (below < 0.35F ? 0.12F * s->white[k] * (1 - below / 0.35F) : 0);
	}
	const float cover = fminf(fmaxf(0.5F + d / c->mm, 0), 1);
	for (int k = 0; k < 3; k++)
		c->rgb[3 * i + k] += cover * (rgb[k] - c->rgb[3 * i + k]);
	if (cover > 0.5F)
		note(c, i, &p, kept, s->white);
}

void open_eye_draw(struct canvas *c, const struct set *s, int e)
{
	const struct lids *l = &s->face.lids[e];
	const struct eye_frame *f = &s->face.frame[e];
	if (l->open <= 0)
		return;
	for (int j = 0; j < c->height; j++)
		for (int i = 0; i < c->width; i++) {
			float uv[2];
			face_uv(uv, c, i, j);
			const float x = (uv[0] - f->at[0]) * f->side / f->narrow, y = uv[1] - f->at[1];
			if (x < l->inner[0] - 1 || x > l->outer[0] + 1 || fabsf(y) > 14)
				continue;
			const struct lid_heights h = lids_at(l, x), next = lids_at(l, x + 0.3F);
			const float su = fminf(fabsf(next.upper - h.upper) / 0.3F, 2), sl = fminf(fabsf(next.lower - h.lower) / 0.3F, 2);
			const float d = fminf((h.upper - y) / sqrtf(1 + su * su), (y - h.lower) / sqrtf(1 + sl * sl));
			if (d > -c->mm && h.upper - h.lower > 0.02F)
				eye_pixel(c, (long)j * c->width + i, s, e, x, y, d, &h, light_shade(&s->light, uv[0], uv[1]));
		}
}

void open_eye_bare(struct canvas *c, const struct set *s, struct rng *rng, bool test)
{
	behind_bare(c, s, rng, test);
	for (int e = 0; e < 2; e++)
		draw_bare(c, s, e);
}
