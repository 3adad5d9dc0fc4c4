#include "scene.h"

#include <stdlib.h>
#include <string.h>

#include "ball.h"
#include "glasses.h"
#include "lens.h"
#include "other.h"
#include "portrait.h"
#include "scene_impl.h"

/* Eyes that look the same way, lids that follow; one in sixteen pairs is closed, of `aside` one looks far aside. */
static void eyes_make(struct set *s, struct rng *rng, bool test, int aside)
{
	const bool wide = rng_below(rng, aside) == 0;
	const float turn = range_of(rng, 0, 6.2831853), away = wide ? sinf(range_of(rng, 0, 0.79)) : sinf((float)fabs(0.14 * rng_normal(rng)));
	const float gx = away * cosf(turn), gy = away * sinf(turn);
	const float open = rng_below(rng, 16) == 0 ? 0 : rng_below(rng, 3) ? range_of(rng, 0.5, 1.1) : range_of(rng, 0.1, 0.6);
	struct rng again = { rng_bits(rng) };
	s->ball[0] = ball_make(rng, test);
	s->ball[1] = s->ball[0];
	for (int e = 0; e < 2; e++) {
		struct rng same = again;
		s->face.lids[e] = lids_make(&same, test, open * (e ? range_of(rng, 0.93, 1.07) : 1), gy);
		const float side = e ? -1 : 1;
		s->face.frame[e] = (struct eye_frame){ { side * 31 * s->face.narrow, range_of(rng, -0.7, 0.7) }, side, s->face.narrow };
		ball_look(&s->ball[e], gx - 0.02F * side + (float)(0.01 * rng_normal(rng)), gy);
	}
}

/* Radius of the iris, px: 5 to 60 in a picture of any size, seldom less or more: the network is run at the scale where they suit. Many
 * are as in the window that is laid round a candidate. */
static float radius_of(struct rng *rng)
{
	const int which = rng_below(rng, 20);
	return expf(which < 3    ? range_of(rng, logf(0.7F), logf(5))
	            : which < 9  ? range_of(rng, logf(5), logf(14))
	            : which < 12 ? range_of(rng, logf(14), logf(30))
	            : which < 18 ? range_of(rng, logf(26), logf(60))
	                         : range_of(rng, logf(60), logf(100)));
}

/* The eye lies somewhere in the picture, and round a small one the face. */
static void look(struct canvas *c, const struct set *s, struct rng *rng, bool no_eye)
{
	const float radius = radius_of(rng);
	const float turn = rng_below(rng, 3) ? (float)(0.2 * rng_normal(rng)) : range_of(rng, 0, 6.2831853);
	const int e = rng_below(rng, 2);
	const float *at = s->face.frame[e].at, fine = radius / (float)c->width;
	float u = at[0], v = at[1];
	if (no_eye) {
		u = range_of(rng, -60, 60);
		v = range_of(rng, -75, -42);
	}
	const float spread = fine < 0.1F ? 0.25F : 0.15F;
	const float x = (float)c->width * (0.5F + spread * (float)rng_normal(rng)), y = (float)c->height * (0.5F + spread * (float)rng_normal(rng));
	canvas_view(c, u, v, x, y, 5.9F / (no_eye ? fminf(radius, 30) : radius), turn, rng_below(rng, 2));
}

/* Clutter behind the face and, at times, over all but what is near the eyes: hats, hands, flowers, clothes. */
static void hide_outside(struct canvas *c, bool *on, struct rng *rng, bool test)
{
	const int which = rng_below(rng, 10), side = rng_below(rng, 3);
	if (which >= 6)
		return;
	for (int j = 0; j < c->height; j++)
		for (int i = 0; i < c->width; i++) {
			float uv[2];
			face_uv(uv, c, i, j);
			const bool over = side == 0 ? uv[1] > 24 : side == 1 ? uv[1] < -26 : fabsf(uv[0]) > 52;
			bool *o = &on[j * c->width + i];
			*o = !*o || (which <= 2 && over);
		}
	other_clutter(c, on, rng, test);
}

/* Skin lit by its relief; what is behind the face is taken as it is. */
static void draw_skin(struct canvas *c, const struct set *s, struct rng *rng, bool test)
{
	const int w = c->width, h = c->height;
	struct skin_point *skin = malloc((size_t)w * (size_t)h * sizeof *skin);
	bool *on = malloc((size_t)w * (size_t)h);
	for (int j = 0; j < h; j++)
		for (int i = 0; i < w; i++) {
			float uv[2];
			face_uv(uv, c, i, j);
			on[j * w + i] = drawn_face_at(&skin[j * w + i], &s->face, uv[0] / s->face.narrow, uv[1]);
		}
	for (int j = 0; j < h; j++)
		for (int i = 0; i < w; i++) {
			const struct skin_point *p = &skin[j * w + i];
			float *rgb = c->rgb + 3 * ((long)j * w + i), lit[3] = { s->white[0], s->white[1], s->white[2] }, shine = 0;
			if (on[j * w + i]) {
				const int l = i > 0 ? -1 : 0, r = i < w - 1, u = j > 0 ? -w : 0, d = j < h - 1 ? w : 0;
				const float hx = (p[r].height - p[l].height) / (float)(r - l), hy = (p[d].height - p[u].height) / ((float)(d - u) / (float)w);
				float n[3] = { -(c->inv[0][0] * hx + c->inv[1][0] * hy), -(c->inv[0][1] * hx + c->inv[1][1] * hy), 1 };
				const float length = 1 / sqrtf(n[0] * n[0] + n[1] * n[1] + 1);
				for (int k = 0; k < 3; k++)
					n[k] *= length;
				light_on(lit, &s->light, n, 0.25F);
				float uv[2];
				face_uv(uv, c, i, j);
				const float shade = light_shade(&s->light, uv[0], uv[1]);
				for (int q = 0; q < s->light.n; q++) {
					const float *t = s->light.source[q].dir, half = (n[0] * t[0] + n[1] * t[1] + n[2] * (t[2] + 1)) / sqrtf(2 + 2 * t[2]);
					shine += s->face.oil * shade * powf(fmaxf(half, 0), 24) * s->light.source[q].irradiance[1];
				}
				for (int k = 0; k < 3; k++)
					lit[k] *= shade * p->open;
			}
			for (int k = 0; k < 3; k++)
				rgb[k] = p->albedo[k] * lit[k] + shine * p->open;
		}
	hide_outside(c, on, rng, test);
	free(skin);
	free(on);
}

/* An ellipse of the ball's frame in px of the picture. */
static void to_picture(float out[5], const float in[5], const struct canvas *c, const struct eye_frame *f)
{
	float p[2], q[2];
	canvas_px(p, c, f->at[0] + in[0], f->at[1] + in[1]);
	canvas_px(q, c, f->at[0] + in[0] + cosf(in[4]), f->at[1] + in[1] + sinf(in[4]));
	out[0] = p[0];
	out[1] = p[1];
	out[2] = in[2] / c->mm;
	out[3] = in[3] / c->mm;
	out[4] = atan2f(q[1] - p[1], q[0] - p[0]);
}

static float shown(const struct drawn *d, const float e[5])
{
	int in = 0;
	const float co = cosf(e[4]), si = sinf(e[4]);
	for (int j = 0; j < d->height; j++)
		for (int i = 0; i < d->width; i++) {
			const float dx = (float)i + 0.5F - e[0], dy = (float)j + 0.5F - e[1], a = (co * dx + si * dy) / e[2], b = (co * dy - si * dx) / e[3];
			in += a * a + b * b < 1 && d->label[j * d->width + i] >= EVIDENCE_SCLERA;
		}
	return (float)in / (3.14159265F * e[2] * e[3]);
}

static void note_eyes(struct drawn *d, const struct set *s, const struct canvas *c)
{
	for (int e = 0; e < 2; e++) {
		struct drawn_eye *eye = &d->eye[d->n_eyes];
		float limbus[5], pupil[5];
		ball_limbus(limbus, &s->ball[e]);
		ball_pupil(pupil, &s->ball[e]);
		to_picture(eye->limbus, limbus, c, &s->face.frame[e]);
		to_picture(eye->pupil, pupil, c, &s->face.frame[e]);
		eye->openness = s->bare ? 2 : s->face.lids[e].open / (2 * s->ball[e].limbus);
		eye->theta = acosf(fminf(s->ball[e].gaze[2], 1));
		d->aspect = s->ball[e].aspect;
		const float *m = eye->limbus;
		if (m[0] < -m[2] || m[1] < -m[2] || m[0] > (float)c->width + m[2] || m[1] > (float)c->height + m[2])
			continue;
		eye->shown = shown(d, eye->limbus);
		d->n_eyes++;
	}
}

/* Hair of the head that falls over the face. */
static void draw_strands(struct canvas *c, const struct set *s, struct rng *rng)
{
	float lit[3];
	for (int k = 0; k < 3; k++)
		lit[k] = 0.8F * s->white[k] * s->face.hair[k];
	const int n = 3 + rng_below(rng, 50);
	const float at = range_of(rng, -60, 60), to = range_of(rng, -60, 60), wide = range_of(rng, 0.06, 0.2), spread = range_of(rng, 3, 30);
	for (int i = 0; i < n; i++) {
		const float a = at + spread * (float)rng_normal(rng), b = to + spread * (float)rng_normal(rng);
		const float p[3][2] = { { a, 70 }, { 0.5F * (a + b) + 12 * (float)rng_normal(rng), 10 }, { b, range_of(rng, -60, 10) } };
		canvas_hair(c, p, wide, lit, 0.9F);
	}
}

static void draw_face(struct canvas *c, const struct set *s, struct rng *rng, bool test)
{
	if (s->bare) {
		open_eye_bare(c, s, rng, test);
		return;
	}
	draw_skin(c, s, rng, test);
	for (int e = 0; e < 2; e++)
		open_eye_draw(c, s, e);
	float dim[3];
	for (int k = 0; k < 3; k++)
		dim[k] = 0.8F * s->white[k];
	struct rng again = { rng_bits(rng) };
	for (int e = 0; e < 2; e++) {
		struct rng same = again;
		lids_draw_lashes(c, &s->face.lids[e], &s->face.frame[e], &same, dim);
		lids_draw_brow(c, &s->face.lids[e], &s->face.frame[e], &same, dim);
	}
	if (!rng_below(rng, 8))
		draw_strands(c, s, rng);
	canvas_label_hair(c);
	if (!rng_below(rng, 6))
		glasses_draw(c, &s->face, s->white, rng);
}

static struct drawn begin(struct set *s, struct rng *rng, bool test, int width, int height)
{
	rng_bits(rng);
	struct drawn d = { .width = width, .height = height, .rgb = malloc((size_t)width * (size_t)height * 3), .label = malloc((size_t)width * (size_t)height) };
	s->face = drawn_face_make(rng, test);
	s->light = light_make(rng, test);
	light_on(s->white, &s->light, (const float[3]){ 0, 0, 1 }, 0.3F);
	eyes_make(s, rng, test, 3);
	d.light = (int)s->light.kind;
	return d;
}

/* What is mirrored, against white. */
static void keep_mirror(struct drawn *d, const struct canvas *c)
{
	const size_t n = (size_t)d->width * (size_t)d->height;
	const float white = 0.2126F * d->white[0] + 0.7152F * d->white[1] + 0.0722F * d->white[2];
	d->mirror = malloc(n * sizeof(float));
	d->body = malloc(n * sizeof(float));
	for (size_t i = 0; i < n; i++) {
		d->mirror[i] = c->mirror[i] / white;
		d->body[i] = c->body[i] / white;
	}
}

/* Draws, exposes and labels what is in view; frees the canvas. */
static void finish(struct drawn *d, struct canvas *c, const struct set *s, struct rng *rng, bool test, bool photo, float rough)
{
	const bool face = d->other == OTHER_NONE || d->other == OTHER_FACE;
	d->iris = (int)s->ball[0].iris.family;
	for (int i = 0; i < 3; i++)
		d->white[i] = face ? s->white[i] : 1;
	if (face)
		draw_face(c, s, rng, test);
	else
		other_draw(c, (enum other_kind)d->other, rng, test);
	lens_expose(d->rgb, c, d->white, 5.9F / c->mm, photo, rough, rng);
	memcpy(d->label, c->label, (size_t)d->width * (size_t)d->height);
	keep_mirror(d, c);
	if (face)
		note_eyes(d, s, c);
	canvas_free(c);
}

/* Other eyes in the same face, as in photographs of people. */
static void as_portrait(struct set *s, uint64_t number, bool test)
{
	struct rng own = { (number * 2 + 1) * 0x9e3779b97f4a7c15 + 5 };
	eyes_make(s, &own, test, 2);
	portrait_make(s, &own);
}

struct drawn drawn_make(uint64_t number, bool test, int width, int height)
{
	struct rng rng = { (number * 2 + test) * 0xd1342543de82ef95 + 77 };
	struct set s = { 0 };
	struct drawn d = begin(&s, &rng, test, width, height);
	struct canvas c = canvas_new(width, height);
	d.other = rng_below(&rng, 7) ? OTHER_NONE : 1 + rng_below(&rng, OTHER_KINDS - 1);
	s.bare = d.other == OTHER_NONE && rng_below(&rng, 14) == 0;
	if (!test && number % 2)
		as_portrait(&s, number, test);
	look(&c, &s, &rng, d.other == OTHER_FACE);
	finish(&d, &c, &s, &rng, test, false, 0);
	return d;
}

/* Limbi of photographed people: 10 to 90 % of the step over 0.2 to 1 mm, the line astray by up to a tenth of a millimetre. */
static void roughen(struct ball ball[2], float rough, struct rng *rng)
{
	if (!(rough > 0))
		return;
	const float blur = range_of(rng, 0.05, 0.12 + 0.25 * rough), ragged = rough * range_of(rng, 0, 0.35), near_limbus = 3 - 2.7F * rough * range_of(rng, 0, 1);
	for (int k = 0; k < 2; k++) {
		ball[k].blur = blur;
		ball[k].ragged = ragged;
		ball[k].near_limbus = near_limbus;
	}
}

struct drawn drawn_photograph(uint64_t number, const struct drawn_view *view, int width, int height)
{
	struct rng rng = { (number * 2 + 1) * 0xd1342543de82ef95 + 1077 };
	struct set s = { 0 };
	struct drawn d = begin(&s, &rng, !view->training, width, height);
	struct canvas c = canvas_new(width, height);
	const int e = rng_below(&rng, 2);
	float limbus[5];
	d.other = view->other;
	s.bare = d.other == OTHER_NONE && rng_below(&rng, 20) == 0;
	if (view->portrait)
		as_portrait(&s, number, !view->training);
	for (int k = 0; k < 2; k++) {
		s.ball[k].even = true;
		s.ball[k].blur *= 0.5F;
	}
	roughen(s.ball, view->rough, &rng);
	if (view->around) {
		struct rng own = { (number * 2 + 1) * 0x9e3779b97f4a7c15 + 11 };
		s.light.around = around_make(&own, !view->training);
	}
	ball_limbus(limbus, &s.ball[e]);
	canvas_view(&c, s.face.frame[e].at[0] + limbus[0], s.face.frame[e].at[1] + limbus[1] - (d.other == OTHER_FACE ? 55 : 0), view->x, view->y,
	            s.ball[e].limbus / view->radius, view->turn, view->mirrored);
	finish(&d, &c, &s, &rng, !view->training, true, view->rough);
	return d;
}

struct drawn drawn_lesson(uint64_t number, int least, struct drawn_view *view)
{
	struct rng rng = { number * 77 + 5 };
	const int width = (int)(least * pow(2.4, rng_uniform(&rng))), height = (int)(width * rng_range(&rng, 0.6, 0.85));
	const double r = exp(rng_range(&rng, log(24), log(0.42 * height)));
	const int other = rng_below(&rng, 5) == 0 ? OTHER_BALL + rng_below(&rng, OTHER_KINDS - OTHER_BALL) : OTHER_NONE;
	*view = (struct drawn_view){ .radius = (float)r, .x = (float)rng_range(&rng, 1.05 * r, width - 1.05 * r),
		.y = (float)rng_range(&rng, 1.05 * r, height - 1.05 * r), .mirrored = rng_below(&rng, 2), .other = other, .training = true,
		.rough = (float)fmax(rng_range(&rng, -0.5, 1), 0),
		.turn = (float)(rng_below(&rng, 3) ? 0.2 * rng_normal(&rng) : rng_range(&rng, 0, 2 * M_PI)) };
	view->portrait = rng_below(&rng, 2);
	return drawn_photograph(number, view, width, height);
}

void drawn_free(struct drawn *d)
{
	free(d->rgb);
	free(d->label);
	free(d->mirror);
	free(d->body);
	*d = (struct drawn){ 0 };
}
