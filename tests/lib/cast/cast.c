#include "tests/lib/cast/cast.h"

#include <stdlib.h>

#include "math/ellipse_fit.h"
#include "tests/lib/cast/cast_impl.h"

struct vec cast_ray(const struct cast *c, double x, double y)
{
	return unit(add(add(c->look[2], (x - c->mid[0]) / c->focal, c->look[0]), (y - c->mid[1]) / c->focal, c->look[1]));
}

/* The eye's axes: its x is the head's but for what lies along the axis. Its limbus's centre lies at `far` on the ray through the frame's
 * point; the head stands round the ball's centre, turned a little against the camera. */
static void place(struct cast *c, struct rng *rng)
{
	const struct cast_frame *f = c->frame;
	struct cast_eye *e = &c->eye;
	const double far = exp(rng_range(rng, log(90), log(700))), yaw = clamp(0.2 * rng_normal(rng), -0.4, 0.4),
	             pitch = clamp(0.12 * rng_normal(rng), -0.25, 0.25);
	c->mid[0] = 0.5 * f->width;
	c->mid[1] = 0.5 * f->height;
	c->focal = f->radius * far / e->limbus;
	// The camera's axes in the head's frame: y and z are turned over, then rolled and turned.
	const double cr = cos(f->turn), sr = sin(f->turn), cy = cos(yaw), sy = sin(yaw), cp = cos(pitch), sp = sin(pitch);
	const struct vec right = vec(cy, 0, -sy), ahead = vec(-sy * cp, -sp, -cy * cp), down = cross(ahead, right);
	c->look[0] = add(scaled(right, cr), sr, down);
	c->look[1] = add(scaled(down, cr), -sr, right);
	c->look[2] = ahead;
	// The gaze, off the way to the camera.
	const struct vec sight = cast_ray(c, f->x, f->y), back = scaled(sight, -1);
	const double off = rng_below(rng, 3) ? fabs(0.22 * rng_normal(rng)) : rng_range(rng, 0, 0.75), way = rng_range(rng, -M_PI, M_PI);
	const struct vec side = unit(cross(vec(0, 1, 0), back)), over = cross(back, side);
	e->axis = unit(add(add(back, tan(fmin(off, 0.85)) * cos(way), side), tan(fmin(off, 0.85)) * sin(way), over));
	e->x = unit(add(c->look[0], -dot(c->look[0], e->axis), e->axis));
	e->y = cross(e->axis, e->x);
	const double back_of = sqrt(e->sclera * e->sclera - e->limbus * e->limbus);
	e->apex = scaled(e->axis, back_of + e->limbus_at);
	c->camera = add(scaled(e->axis, back_of), -far / dot(sight, c->look[2]), sight);
}

static void lids_make(struct cast *c, struct rng *rng)
{
	struct cast_lids *l = &c->lids;
	const double side = c->frame->left ? -1 : 1, gaze = asin(clamp(c->eye.axis.y, -1, 1)), across = atan2(c->eye.axis.x, c->eye.axis.z);
	const double open = rng_below(rng, 5) ? rng_range(rng, 0.6, 1.3) : rng_range(rng, 0.15, 0.6), slant = rng_range(rng, -0.05, 0.12);
	const double mid = 0.35 * across;
	l->inner[0] = mid - side * rng_range(rng, 0.85, 0.97);
	l->outer[0] = mid + side * rng_range(rng, 0.88, 1.02);
	l->inner[1] = -0.08;
	l->outer[1] = -0.08 + slant;
	// Heights are angles on the shell; lids follow the gaze up and down.
	const double gap = open * 2 * c->eye.limbus * c->eye.aspect / 13;
	l->rise[0] = fmax(0.52 * gap + 0.08 + 0.7 * gaze, -0.3);
	l->rise[1] = fmax(0.48 * gap - 0.08 - 0.6 * gaze, 0.08 - l->rise[0]);
	for (int k = 0; k < 2; k++) {
		l->skew[k] = rng_range(rng, 0.8, 1.15);
		l->full[k] = rng_range(rng, 0.6, 1);
	}
	l->shell = c->eye.sclera + rng_range(rng, 1, 1.6);
	l->crease = rng_range(rng, 0.08, 0.4);
	l->crease_deep = rng_range(rng, 0, 1.2);
	l->puff = rng_range(rng, 0, 1.2);
	l->bag = rng_range(rng, 0, 1.2);
	l->brow = rng_range(rng, 1, 5);
	l->nose = rng_range(rng, 4, 10);
	l->depth = rng_range(rng, 8, 11);
}

static void skin_make(struct cast_skin *s, struct rng *rng)
{
	const double melanin = rng_uniform(rng), level = exp(-0.3 - 2.2 * melanin);
	s->rgb[0] = pow(level, 0.75) * rng_range(rng, 0.85, 1);
	s->rgb[1] = pow(level, 1.05) * rng_range(rng, 0.7, 0.82);
	s->rgb[2] = pow(level, 1.25) * rng_range(rng, 0.55, 0.75);
	s->oil = rng_range(rng, 0, 0.5);
	s->pores = rng_range(rng, 0.2, 1);
	s->wrinkle = rng_below(rng, 2) ? rng_range(rng, 0, 0.3) : rng_range(rng, 0.3, 1);
	s->spots = rng_below(rng, 3) ? 0 : rng_range(rng, 0, 1);
	s->red = rng_range(rng, 0, 1);
	s->seed = (uint32_t)rng_bits(rng);
}

static float *expose(const struct cast *c)
{
	const int w = c->frame->width, h = c->frame->height;
	float *linear = malloc(sizeof *linear * 3 * (size_t)w * (size_t)h);
	static const double at[4][2] = { { 0.375, 0.125 }, { 0.875, 0.375 }, { 0.125, 0.625 }, { 0.625, 0.875 } };
	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++) {
			double sum[3] = { 0 }, one[3];
			struct cast_seen seen;
			// Skin is smooth: away from the lids' margins one ray does.
			cast_trace(sum, &seen, c, cast_ray(c, x + 0.5, y + 0.5));
			for (int k = 0; k < 4 && seen.inside > -0.03; k++) {
				struct cast_seen more;
				cast_trace(one, &more, c, cast_ray(c, x + at[k][0], y + at[k][1]));
				for (int i = 0; i < 3; i++)
					sum[i] = k ? sum[i] + 0.25 * one[i] : 0.25 * one[i];
			}
			const double hair = c->hair[(long)y * w + x];
			for (int i = 0; i < 3; i++)
				linear[3 * ((long)y * w + x) + i] = (float)(sum[i] + hair * (c->hair_rgb[i] - sum[i]));
		}
	return linear;
}

/* The pupil's margin along rays of the picture from a point inside of it. */
static void tell_pupil(struct ellipse *pupil, const struct cast *c)
{
	enum { N = 36, STEPS = 40 };
	double middle[2], p[N][2];
	// The cornea lifts the pupil: it is seen near where its centre would be, were it 0.6 mm nearer.
	cast_project(middle, c, add(c->eye.apex, -(c->eye.depth - 0.6), c->eye.axis));
	for (int k = 0; k < N; k++) {
		double low = 0, high = c->frame->radius;
		for (int i = 0; i < STEPS; i++) {
			const double r = 0.5 * (low + high), x = middle[0] + r * cos(2 * M_PI * k / N), y = middle[1] + r * sin(2 * M_PI * k / N);
			if (cast_meets_pupil(c, cast_ray(c, x, y)))
				low = r;
			else
				high = r;
			p[k][0] = x;
			p[k][1] = y;
		}
	}
	ellipse_fit_direct(pupil, N, p, 0);
}

static void tell(struct cast_truth *t, const struct cast *c)
{
	enum { N = 360 };
	const struct cast_eye *e = &c->eye;
	const struct vec middle = add(e->apex, -e->limbus_at, e->axis);
	double px[N][2], rgb[3];
	struct cast_seen seen;
	int shows = 0;
	for (int i = 0; i < N; i++) {
		const double a = 2 * M_PI * i / N;
		const struct vec p = add(add(middle, e->limbus * cos(a), e->x), e->limbus * e->aspect * sin(a), e->y);
		cast_project(px[i], c, p);
		const int x = (int)px[i][0], y = (int)px[i][1];
		if (x < 0 || y < 0 || x >= c->frame->width || y >= c->frame->height || c->hair[(long)y * c->frame->width + x] > 0.5F)
			continue;
		const enum cast_hit hit = cast_trace(rgb, &seen, c, unit(add(p, -1, c->camera)));
		shows += (hit == CAST_IRIS || hit == CAST_SCLERA) && seen.mirrored < 0.5;
	}
	ellipse_fit_direct(&t->limbus, N, px, 0);
	t->showing = (double)shows / N;
	tell_pupil(&t->pupil, c);
	double m[2];
	cast_margins(m, &c->lids, atan2(middle.x, middle.z));
	t->opening = fmax(m[0] - m[1], 0) * c->lids.shell / (2 * e->limbus * e->aspect);
	t->theta = acos(clamp(dot(e->axis, unit(add(c->camera, -1, middle))), -1, 1));
	t->aspect = e->aspect;
	t->focal_px = c->focal;
}

uint8_t *cast_render(struct cast_truth *truth, const struct cast_frame *frame, struct rng *rng)
{
	const size_t n = (size_t)frame->width * (size_t)frame->height;
	struct cast c = { .frame = frame, .hair = calloc(n, sizeof(float)) };
	cast_lamps(&c.room, rng);
	cast_eye_make(&c.eye, rng);
	if (frame->animal)
		cast_eye_of_animal(&c.eye, rng);
	place(&c, rng);
	lids_make(&c, rng);
	skin_make(&c.skin, rng);
	double white[3];
	cast_light(white, &c.room, vec(0, 0, 1), 1);
	const double tone = rng_range(rng, 0.01, 0.2), warm = 0.3 * rng_uniform(rng);
	for (int i = 0; i < 3; i++)
		c.hair_rgb[i] = tone * white[i] * (1 - warm * i);
	cast_hairs(&c, rng);
	tell(truth, &c);
	float *linear = expose(&c);
	uint8_t *rgb = malloc(3 * n);
	truth->warmth = cast_film(rgb, linear, frame->width, frame->height, white, rng);
	free(linear);
	free(c.hair);
	return rgb;
}
