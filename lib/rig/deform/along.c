#include "rig/deform/along.h"

#include <math.h>

#include "math/rising.h"
#include "math/vec.h"
#include "rig/deform/opening.h"
#include "rig/deform/slide.h"

enum { LOWERED = 3 };  // rounds
/* mm of an eyeball of 12 mm: the limbus' radius, and how far its middle is from the centre; by how much a lower lid goes down beyond what was learnt, at most (half as much
 * again where the person's own covers less); lids less apart than the first are shutting, from the second they are not; the same of upper lids, which follow in part and wholly. */
static const double limbus_mm = 5.7, iris_mm = 10.6, lowered_mm = 3.5, open_mm[] = { 1, 4.5 }, follow_mm[] = { 2, 6 };
static const double own_deg = 10;     // down, from where on a lower lid covers no more of the iris than the person's own; looking ahead it is the character's
/* Of an eye that looks further up or down than was filmed the upper lid goes so much of the way: lids go with the eye nearly one to one (Evinger et al. 1991). */
static const double follows = 0.9;
const double deform_goes_along_mm[2] = { 1.5, 8 };

/* Most along the middle of a lid, 0 at its ends. */
static double along_lid(double t)
{
	const double off = (2 * t - 1) * (2 * t - 1);
	return 1 - off * off;
}

/* Share of the iris' disc below a lower margin that is let down by so much, most in the lid's middle. eye: its middle, as the front sees it. */
static double covered(const struct deform_opening *o, const double eye[3], double radius, double down)
{
	enum { STEPS = 48 };
	const double flat = eye[2] / vec_norm(eye);  // a disc that is turned aside is seen narrower, by the front
	double under = 0, all = 0;
	for (int i = 0; i < STEPS; i++) {
		const double x = ((i + 0.5) / STEPS * 2 - 1) * radius, half = sqrt(radius * radius - x * x), column = (eye[0] + x * flat) / o->step + DEFORM_COLUMNS / 2;
		const int at = (int)fmin(fmax(lrint(column), o->first), o->last);
		const double bottom = o->bottom[at] - down * along_lid(fmin(fmax((column - o->first) / (o->last - o->first), 0), 1)), low = eye[1] - half;
		under += fmin(fmax(bottom - low, 0), 2 * half);
		all += 2 * half;
	}
	return under / all;
}

/* How far down the middle of the lower lid has to go so that it covers no more of the iris than the person's own, mm; less, the less the eye looks down. */
static double above_own(const struct rig *rig, int side, const double eye[3], const struct deform_opening *now)
{
	const double degree = M_PI / 180, unit = rig->globe[side].radius / 12, v = asin(fmin(fmax(eye[1] / vec_norm(eye), -1), 1)) / degree, h = atan2(eye[0], eye[2]) / degree;
	const double own = own_low_at(&rig->own_low, side, h, v);
	double low = 0, high = 2 * lowered_mm * unit;
	if (covered(now, eye, limbus_mm * unit, 0) <= own)
		return 0;
	for (int k = 0; k < 20; k++) {
		const double middle = 0.5 * (low + high);
		if (covered(now, eye, limbus_mm * unit, middle) > own)
			low = middle;
		else
			high = middle;
	}
	return rising(-v, 0, own_deg) * high;
}

/* x where it is small, at most `most`, 0 where x is negative. */
static double soft(double x, double most)
{
	return most * tanh(fmax(x, 0) / most);
}

/* A margin, and skin next to it, goes up by so much over the eyeball in the lid's middle, mm. lid: [rig.n] shares in it; far: that much further off skin still goes along. */
static void take_along(float (*x)[3], const struct rig *rig, int side, const double target_from_globe[3][3], const float *lid, const struct deform_opening *o, bool upper, double up, double far)
{
	const double unit = rig->globe[side].radius / 12, span = o->last - o->first;
	for (int i = 0; i < rig->n; i++) {
		double p[3];
		if (!(lid[i] > 0) || rig->side[i] != side)
			continue;
		deform_in_head(p, rig, side, x[i]);
		const double t = fmin(fmax((p[0] / o->step + DEFORM_COLUMNS / 2 - o->first) / span, 0), 1);
		const int column = o->first + (int)lrint(t * span);
		const double off = (upper ? p[1] - o->top[column] : o->bottom[column] - p[1]) / unit;
		const double with = (double)lid[i] * (1 - rising(off, deform_goes_along_mm[0], deform_goes_along_mm[1] + far / unit));
		if (p[2] > 0)
			deform_slide(x[i], rig, side, target_from_globe, with * up * along_lid(t));
	}
}

/* Lowers the lower lid of an eye that looks down, to height *to before the iris; NAN: out. */
static void retract(double *to, float (*x)[3], const struct rig *rig, const struct deform_near *near, int side, const double target_from_globe[3][3], double lifted)
{
	const struct deform_opening *rest = &near->rest[side];
	const double unit = rig->globe[side].radius / 12;
	double axis[3], eye[3];
	struct deform_opening now;
	mat_vec(axis, target_from_globe, (double[]){ 0, 0, iris_mm * unit });
	mat_vec(eye, rig->head_from_target, axis);
	if (!(eye[1] < 0) || rest->last - rest->first < DEFORM_OPENING_LEAST)
		return;
	deform_open(&now, rig, near, side, (const float(*)[3])x, near->within[side]);
	const int at = (int)fmin(fmax(lrint(eye[0] / rest->step) + DEFORM_COLUMNS / 2, rest->first), rest->last);
	if (now.last - now.first < DEFORM_OPENING_LEAST || at <= now.first || at >= now.last)
		return;
	const double span = now.last - now.first, peak = fmax(along_lid((at - now.first) / span), 0.3), most = lowered_mm * unit;
	if (isnan(*to))
		*to = now.bottom[at] - fmax(soft(now.bottom[at] - eye[1] - rest->bottom[at] - lifted, most), soft(peak * above_own(rig, side, eye, &now) - lifted, 1.5 * most)) * rising((now.top[at] - now.bottom[at]) / unit, open_mm[0], open_mm[1]);
	const double lack = now.bottom[at] - *to;
	if (lack > 0)
		take_along(x, rig, side, target_from_globe, near->lower, &now, false, -lack / peak, lack);
}

/* Lowers the lower lids of eyes that look down, as people's do, until they cover no more of the iris, at its middle, than the lid at rest does there of one that
 * looks to the same side, and than the person's own lid does: what was learnt of somebody whose lids are wide apart leaves a character's, which are not, across the pupil. As lids shut that
 * ends. What an expression lifts them by they keep. */
static void lower(float (*x)[3], const struct rig *rig, const struct deform_near *near, int side, const double target_from_globe[3][3], double lifted)
{
	double to = NAN;
	for (int k = 0; k < LOWERED; k++)
		retract(&to, x, rig, near, side, target_from_globe, lifted);
}

/* Upper lids are driven by the nearest gaze that is known (model/known.h). What the eye looks further down or up they go with it, or white would stand above an iris
 * that looks far down. As lids shut that ends. */
static void follow(float (*x)[3], const struct rig *rig, const struct deform_near *near, int side, const double target_from_globe[3][3])
{
	const double degree = M_PI / 180, unit = rig->globe[side].radius / 12;
	double axis[3], eye[3];
	struct deform_opening now;
	mat_vec(axis, target_from_globe, (double[]){ 0, 0, 1 });
	mat_vec(eye, rig->head_from_target, axis);
	const double v = asin(fmin(fmax(eye[1], -1), 1)), h = atan2(eye[0], eye[2]);
	double held[3] = { h / degree, v / degree, 0 };
	known_hold(held, &rig->known, side);
	const double down = follows * iris_mm * unit * (sin(held[1] * degree) - sin(v));
	if (!(fabs(down) > 1e-3 * unit))
		return;
	deform_open(&now, rig, near, side, (const float(*)[3])x, near->within[side]);
	if (now.last - now.first < DEFORM_OPENING_LEAST)
		return;
	double widest = 0;
	for (int i = now.first; i <= now.last; i++)
		widest = fmax(widest, now.top[i] - now.bottom[i]);
	const double open = rising(widest / unit, follow_mm[0], follow_mm[1]);
	if (open > 0)
		take_along(x, rig, side, target_from_globe, near->upper, &now, true, -open * down, fabs(down));
}

void deform_along(float (*x)[3], const struct rig *rig, const struct deform_near *near, int side, const double target_from_globe[3][3], double lifted)
{
	lower(x, rig, near, side, target_from_globe, lifted);
	follow(x, rig, near, side, target_from_globe);
}
