#include "limbus/overlay.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_photo.h"

struct canvas {
	int width, height;
	double x0, y0, scale;  // photo px of its corner; canvas px in one photo px
	uint8_t *px;
};

static void to_canvas(double out[2], const struct canvas *c, const double photo[2])
{
	out[0] = (photo[0] - c->x0) * c->scale;
	out[1] = (photo[1] - c->y0) * c->scale;
}

struct ink {
	double r, g, b, alpha;
};
static const struct ink USED = { 64, 224, 208, 0.95 }, HIDDEN = { 255, 120, 60, 0.95 }, CURVE = { 255, 255, 255, 0.55 },
	PUPIL = { 255, 214, 80, 0.9 }, AXIS = { 255, 70, 120, 0.95 }, SHADE = { 0, 0, 0, 0.35 };

static const double SMALL = 0.08;             // of the longer side: smaller semi-axes are of faces
static const double WIDE = 4, HIGH = 3;      // semi-axes to each side that are drawn of these
static const double LARGEST = 6;             // canvas px in one photo px

static void blend(struct canvas *c, int x, int y, const struct ink *ink, double cover)
{
	if (x < 0 || y < 0 || x >= c->width || y >= c->height || cover <= 0)
		return;
	uint8_t *p = c->px + 3 * ((long)y * c->width + x);
	double a = ink->alpha * fmin(cover, 1);
	p[0] = (uint8_t)lround(p[0] + a * (ink->r - p[0]));
	p[1] = (uint8_t)lround(p[1] + a * (ink->g - p[1]));
	p[2] = (uint8_t)lround(p[2] + a * (ink->b - p[2]));
}

/* Antialiased stroke of half-width w from p to q, canvas px; each pixel covered by its distance. */
static void stroke(struct canvas *c, const double p[2], const double q[2], double w, const struct ink *ink)
{
	int x0 = (int)floor(fmin(p[0], q[0]) - w - 1), x1 = (int)ceil(fmax(p[0], q[0]) + w + 1);
	int y0 = (int)floor(fmin(p[1], q[1]) - w - 1), y1 = (int)ceil(fmax(p[1], q[1]) + w + 1);
	double dx = q[0] - p[0], dy = q[1] - p[1], len2 = dx * dx + dy * dy;
	for (int y = y0 < 0 ? 0 : y0; y <= y1 && y < c->height; y++)
		for (int x = x0 < 0 ? 0 : x0; x <= x1 && x < c->width; x++) {
			double u = x + 0.5 - p[0], v = y + 0.5 - p[1];
			double t = len2 > 0 ? fmin(fmax((u * dx + v * dy) / len2, 0), 1) : 0;
			blend(c, x, y, ink, w + 0.5 - hypot(u - t * dx, v - t * dy));
		}
}

/* The curve as thin strokes that meet without overlap: coverage of a whole ellipse by its distance field. */
static void draw_ellipse(struct canvas *c, const struct ellipse *e, double w, const struct ink *ink)
{
	const double k = c->scale, cs = cos(e->angle), sn = sin(e->angle), a = e->a * k, b = e->b * k;
	const double hx = hypot(a * cs, b * sn), hy = hypot(a * sn, b * cs), cx = (e->cx - c->x0) * k, cy = (e->cy - c->y0) * k;
	for (int y = (int)fmax(floor(cy - hy - w - 2), 0); y < c->height && y <= cy + hy + w + 2; y++)
		for (int x = (int)fmax(floor(cx - hx - w - 2), 0); x < c->width && x <= cx + hx + w + 2; x++) {
			double u = x + 0.5 - cx, v = y + 0.5 - cy, p = cs * u + sn * v, q = cs * v - sn * u;
			/* first-order distance: f / |grad f| of the implicit curve */
			double f = p * p / (a * a) + q * q / (b * b) - 1, g = 2 * hypot(p / (a * a), q / (b * b));
			if (g > 0 && fabs(f) < 0.2)
				blend(c, x, y, ink, w + 0.5 - fabs(f / g));
		}
}

static void draw_points(struct canvas *c, const struct limbus_record *r)
{
	const double dot = fmax(1.2, 0.0038 * r->view.limbus.a * c->scale);
	for (int i = 0; i < ARCS; i++) {
		double p[2];
		to_canvas(p, c, r->point[i]);
		if (r->state[i] == ARC_USED)
			stroke(c, p, p, dot, &USED);
		else if (r->state[i] == ARC_HIDDEN) {
			const double *next = r->point[(i + 1) % ARCS];
			double q[2];
			to_canvas(q, c, next);
			if (r->state[(i + 1) % ARCS] == ARC_HIDDEN && i % 3 < 2)
				stroke(c, p, q, dot, &HIDDEN);
		}
	}
}

/* From the limbus' centre along the axis out of the eye, as long in space as the limbus' diameter. */
static void draw_axis(struct canvas *c, const struct fit *fit, double depth, double length)
{
	double from[3] = { 0, 0, depth }, to[3] = { 0, 0, depth - length }, p[2], q[2];
	if (!fit_project(p, fit, from) || !fit_project(q, fit, to))
		return;
	to_canvas(p, c, p);
	to_canvas(q, c, q);
	const double w = fmax(1.2, 0.005 * fit->limbus.a * c->scale), dx = q[0] - p[0], dy = q[1] - p[1];
	const double len = hypot(dx, dy), head = fmin(8 * w, 0.4 * len);
	stroke(c, p, q, w + 1.2, &SHADE);
	stroke(c, p, p, 2.6 * w, &AXIS);
	stroke(c, p, q, w, &AXIS);
	for (int side = -1; side <= 1 && len > 4 * w; side += 2) {
		double back[2] = { q[0] - head * (0.87 * dx + side * 0.5 * dy) / len, q[1] - head * (0.87 * dy - side * 0.5 * dx) / len };
		stroke(c, q, back, w, &AXIS);
	}
}

/* An ellipse that is not believed. */
static void draw_doubtful(struct canvas *c, const struct ellipse *e, const struct ink *colour)
{
	const double thin = fmax(0.7, 0.0018 * e->a * c->scale);
	draw_ellipse(c, e, thin + 1, &SHADE);
	draw_ellipse(c, e, thin, colour);
}

struct shown { int x0, y0, width, height; bool part; };

/* The part of the photograph that is drawn: all of it, or where an eye is small in it, that eye. */
static struct shown shown_of(const struct photo *photo, const struct ellipse *e)
{
	struct shown s = { 0, 0, photo->width, photo->height, false };
	if (!e || e->a > SMALL * fmax(photo->width, photo->height))
		return s;
	const double wide = WIDE * e->a, high = HIGH * e->a;
	s.part = true;
	s.x0 = (int)fmin(fmax(e->cx - wide, 0), photo->width - 1);
	s.y0 = (int)fmin(fmax(e->cy - high, 0), photo->height - 1);
	s.width = (int)fmax(fmin(2 * wide, photo->width - s.x0), 1);
	s.height = (int)fmax(fmin(2 * high, photo->height - s.y0), 1);
	return s;
}

uint8_t *limbus_overlay(int *width, int *height, int most_px, const struct photo *photo, const struct limbus_record *record,
                        const struct fit *fit)
{
	const struct shown s = shown_of(photo, record->ok ? &fit->limbus : record->has_guess ? &record->guess : 0);
	const int longer = s.width > s.height ? s.width : s.height;
	const double scale = longer > most_px ? (double)most_px / longer : !s.part ? 1 : fmin((double)most_px / longer, LARGEST);
	uint8_t *full = mem_array(3 * (size_t)s.width * (size_t)s.height, 1);
	for (int y = 0; y < s.height; y++)
		for (int i = 0; i < 3 * s.width; i++)
			full[3L * y * s.width + i] = (uint8_t)(photo->rgb[3 * ((long)(y + s.y0) * photo->width + s.x0) + i] >> 8);
	struct canvas c = { s.width, s.height, s.x0, s.y0, scale, full };
	if (scale != 1) {
		c.width = (int)fmax(1, lround(s.width * scale));
		c.height = (int)fmax(1, lround(s.height * scale));
		c.px = cv_resize8(full, s.width, s.height, 3, c.width, c.height);
		free(full);
	}
	if (record->ok) {
		const double thin = fmax(0.7, 0.0018 * fit->limbus.a * scale);
		draw_ellipse(&c, &fit->limbus, thin + 1, &SHADE);
		draw_ellipse(&c, &fit->limbus, thin, &CURVE);
		if (fit->has_pupil) {
			draw_ellipse(&c, &fit->pupil, thin + 1.5, &SHADE);
			draw_ellipse(&c, &fit->pupil, thin + 0.3, &PUPIL);
		}
		draw_points(&c, record);
		draw_axis(&c, fit, 2.7, 8);
	}
	if (!record->ok) {
		if (record->has_guess)
			draw_doubtful(&c, &record->guess, &CURVE);
		if (record->has_rival)
			draw_doubtful(&c, &record->rival, &HIDDEN);
	}
	*width = c.width;
	*height = c.height;
	return c.px;
}
