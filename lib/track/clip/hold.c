#include "track/clip/hold.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"
#include "math/walk.h"

/* mm: the line through the corners of the eye lies lower on people than on the mean opening (subject.c): of heads of a model made from scans 2.2 +- 0.2 below the eyeballs'
 * centres, of that opening 0.5; between both. */
static const double LOWER = 0.9;
static const double ASIDE = 0.8;       // mm: and the middle between them further to the temple, of those heads by 1.6, of that opening by none
static const double OPEN = 2;          // squares of the iris' radius: eyes that show less tell no corners
static const double AGREE = 0.8;       // radii: skin that tells the eyes so near to where they are is believed on the way
static const double LOST_S = 0.25;     // longer than most blinks
enum { ROUNDS = 6, LEAST_FRAMES = 12 };

/* A similarity of the picture about the middle between the eyes: shift, px; lean, radians; logarithm of the size. */
enum { ACROSS, DOWN, LEAN, SIZE, MOTIONS };
static const double follow_s[MOTIONS] = { 0.02, 0.02, 0.05, 0.2 };    // seconds over which each is followed on the way
static const double least[MOTIONS] = { 0.03, 0.03, 0.005, 0.005 };    // radii of the iris, radians: scatter of a frame's, at least
static const double least_bend[MOTIONS] = { 0.003, 0.003, 0.0005, 0.0003 };

struct seen { float corner[SIDES][2][2]; bool known[SIDES]; };

struct hold {
	const struct track_clip *clip;
	const struct track_subject *subject;
	double large_px;
	double now[MOTIONS];
	double radius;                 // px, of the irises, last
	double lost_s;                 // since eyes were told
	long n, room;
	struct seen *seen;             // [n]
};

struct hold *hold_new(const struct track_clip *clip, const struct track_subject *subject, double large_px)
{
	struct hold *h = mem_new(1, sizeof *h);
	h->clip = clip;
	h->subject = subject;
	h->large_px = large_px;
	h->lost_s = INFINITY;
	return h;
}

void hold_free(struct hold *h)
{
	if (h)
		free(h->seen);
	free(h);
}

/* The middle between the eyes in a pose, mm. */
static void middle_in(double at[3], const struct hold *h, const double pose[4][4])
{
	double middle[3] = { 0 };
	int n = 0;
	for (int e = 0; e < SIDES; e++)
		for (int k = 0; k < 3 && h->subject->opening[e].open; k++, n++)
			middle[k] += h->subject->opening[e].center[k];
	for (int k = 0; k < 3; k++)
		middle[k] /= fmax(1, n / 3.0);
	head_from(at, pose, middle);
}

/* The reference's pose so moved. */
static void moved(double pose[4][4], const struct hold *h, const double by[MOTIONS])
{
	const struct camera *camera = &h->clip->camera;
	const double c = cos(by[LEAN]), s = sin(by[LEAN]);
	double at[3], rest[3], px[2];
	memcpy(pose, h->clip->cam_from_head, sizeof(double[4][4]));
	middle_in(at, h, h->clip->cam_from_head);
	if (!camera_project(px, camera, at))
		return;
	for (int k = 0; k < 3; k++) {
		const double x = pose[0][k], y = pose[1][k];
		pose[0][k] = c * x - s * y;
		pose[1][k] = s * x + c * y;
		pose[0][3] = pose[1][3] = pose[2][3] = 0;
	}
	middle_in(rest, h, (const double(*)[4])pose);
	double ray[3];
	camera_ray(ray, camera, (double[2]){ px[0] + by[ACROSS], px[1] + by[DOWN] });
	const double z = at[2] * exp(-by[SIZE]);
	for (int k = 0; k < 3; k++)
		pose[k][3] = ray[k] / ray[2] * z - rest[k];
}

/* Where a pose has the corners, px. */
static bool expected(double px[SIDES][2][2], const struct hold *h, const double pose[4][4])
{
	for (int e = 0; e < SIDES; e++)
		for (int c = 0; c < 2; c++) {
			const double *at = h->subject->opening[e].canthus[c];
			if (!head_project(px[e][c], &h->clip->camera, pose, (double[3]){ at[0] + (e == SIDE_LEFT ? ASIDE : -ASIDE), at[1] - LOWER, at[2] }))
				return false;
		}
	return true;
}

/* How the corners lie against the reference's. Lids that close move the inner corners apart, alike in both eyes: their middle stays. One eye alone tells no lean and no size (NAN);
 * those of `about` are taken for it. Returns false where too little shows. */
static bool motion_of(double by[MOTIONS], const struct hold *h, const struct seen *s, const double about[MOTIONS])
{
	double px[SIDES][2][2], off[SIDES][2][2], told[SIDES][2], was[SIDES][2];
	if (!(s->known[0] || s->known[1]) || !expected(px, h, h->clip->cam_from_head))
		return false;
	for (int e = 0; e < SIDES; e++)
		for (int k = 0; k < 2; k++) {
			told[e][k] = 0.5 * (double)(s->corner[e][0][k] + s->corner[e][1][k]);
			was[e][k] = 0.5 * (px[e][0][k] + px[e][1][k]);
			for (int c = 0; c < 2; c++)
				off[e][c][k] = (double)s->corner[e][c][k] - px[e][c][k];
		}
	by[LEAN] = by[SIZE] = NAN;
	if (s->known[0] && s->known[1]) {
		by[ACROSS] = 0.5 * (off[0][0][0] + off[1][0][0]);
		by[DOWN] = 0.25 * (off[0][0][1] + off[0][1][1] + off[1][0][1] + off[1][1][1]);
		const double to[2] = { told[0][0] - told[1][0], told[0][1] - told[1][1] }, from[2] = { was[0][0] - was[1][0], was[0][1] - was[1][1] };
		by[LEAN] = atan2(from[0] * to[1] - from[1] * to[0], from[0] * to[0] + from[1] * to[1]);
		by[SIZE] = log(hypot(to[0], to[1]) / hypot(from[0], from[1]));
		return isfinite(by[SIZE]);
	}
	const int e = s->known[0] ? 0 : 1;
	double pose[4][4];
	moved(pose, h, about);
	if (!expected(px, h, (const double(*)[4])pose))
		return false;
	for (int k = 0; k < 2; k++)
		by[k] = about[k] + told[e][k] - 0.5 * (px[e][0][k] + px[e][1][k]);
	return true;
}

bool hold_large(const struct hold *h)
{
	return h->radius >= h->large_px;
}

void hold_guess(double pose[4][4], const struct hold *h, const double skin_pose[4][4])
{
	double held[3], skin[3], px[2][2];
	moved(pose, h, h->now);
	middle_in(held, h, (const double(*)[4])pose);
	middle_in(skin, h, skin_pose);
	if (hold_large(h) && camera_project(px[0], &h->clip->camera, held) && camera_project(px[1], &h->clip->camera, skin)
	    && hypot(px[0][0] - px[1][0], px[0][1] - px[1][1]) < AGREE * h->radius)
		memcpy(pose, skin_pose, sizeof(double[4][4]));
}

static struct seen seen_of(const struct eye_told *const told[SIDES])
{
	struct seen s = { 0 };
	for (int e = 0; e < SIDES; e++) {
		s.known[e] = told[e] && told[e]->area > OPEN;
		for (int k = 0; k < 4 && s.known[e]; k++)
			s.corner[e][k / 2][k % 2] = (float)told[e]->corner[k / 2][k % 2];
	}
	return s;
}

bool hold_lost(const struct hold *h)
{
	return h->lost_s > LOST_S;
}

void hold_found(struct hold *h, const double eye[SIDES][2])
{
	double px[2], middle[2] = { 0 };
	h->lost_s = 0;
	for (int e = 0; e < SIDES && eye; e++) {
		if (!head_project(px, &h->clip->camera, h->clip->cam_from_head, h->subject->opening[e].center))
			return;
		for (int k = 0; k < 2; k++)
			middle[k] += 0.5 * (eye[e][k] - px[k]);
	}
	if (eye)
		memcpy(h->now, middle, sizeof middle);
}

void hold_push(struct hold *h, const struct eye_told *const told[SIDES], double radius, double dt, bool keep)
{
	const struct seen seen = seen_of(told);
	double by[MOTIONS];
	const bool any = motion_of(by, h, &seen, h->now);
	h->lost_s = !keep ? INFINITY : seen.known[0] && seen.known[1] ? 0 : h->lost_s + dt;
	if (any)
		for (int k = 0; k < MOTIONS; k++)
			h->now[k] += isnan(by[k]) ? 0 : (dt > 0 ? 1 - exp(-dt / follow_s[k]) : 1) * (by[k] - h->now[k]);
	if (radius > 0)
		h->radius = radius;
	if (!keep)
		return;
	if (h->n == h->room)
		h->seen = mem_grow(h->seen, (size_t)(h->room = 2 * h->room + 256), sizeof *h->seen);
	h->seen[h->n++] = seen;
}

/* The path of y (NAN: not known) that goes on as it did but for what the clip itself shows of changes; what is far off counts little. x: overwritten. */
static void path(double *x, long n, const double *y, double noise_least, double bend_least)
{
	double *sigma = mem_array((size_t)n + 1, sizeof *sigma), *room = mem_array(2 * (size_t)n + 1, sizeof *room), noise, bend;
	walk_unrest(&noise, &bend, n, y, room);
	noise = fmax(noise, noise_least);
	for (int round = 0; round < ROUNDS; round++) {
		for (long i = 0; i < n; i++) {
			const double off = round ? (y[i] - x[i]) / (3 * noise) : 0;
			sigma[i] = isnan(y[i]) ? 1e4 * noise : noise * sqrt(1 + off * off);
			x[i] = isnan(y[i]) ? 0 : y[i];
		}
		walk_glide(n, x, sigma, fmax(bend, bend_least), room);
	}
	free(sigma);
	free(room);
}

static double gap(const float a[2], const float b[2])
{
	return hypot((double)(a[0] - b[0]), (double)(a[1] - b[1]));
}

/* How well the middle between the inner corners is known in a frame, px: these lie as far apart in all frames, but for the head's distance. */
static double place_of(const struct hold *h, long n)
{
	double *apart = mem_array((size_t)n + 1, sizeof *apart), *middle = mem_array((size_t)n + 1, sizeof *middle), *off = mem_array((size_t)n + 1, sizeof *off);
	int m = 0;
	for (long i = 0; i < n; i++) {
		const struct seen *s = &h->seen[i];
		apart[i] = s->known[0] && s->known[1] ? gap(s->corner[SIDE_LEFT][0], s->corner[SIDE_RIGHT][0]) : NAN;
	}
	path(middle, n, apart, 0.3 * h->radius, least_bend[SIZE] * h->radius);
	for (long i = 0; i < n; i++)
		if (isfinite(apart[i]))
			off[m++] = apart[i] - middle[i];
	const double sigma = m ? 0.5 * stats_mad(m, off, 0) : 0;
	free(apart);
	free(middle);
	free(off);
	return sigma;
}

/* How far the head turns aside in the clip, radians, one standard deviation: the eye on the far side looks narrower. */
static double turns_of(const struct hold *h, long n)
{
	const double per_radian = 0.65, scatter = 0.03;  // lids slant by 18 degrees against the face; of the logarithm of the widths' ratio in a frame
	double *ratio = mem_array((size_t)n + 1, sizeof *ratio);
	int m = 0;
	for (long i = 0; i < n; i++) {
		const struct seen *s = &h->seen[i];
		if (s->known[0] && s->known[1])
			ratio[m++] = log(gap(s->corner[SIDE_LEFT][0], s->corner[SIDE_LEFT][1]) / gap(s->corner[SIDE_RIGHT][0], s->corner[SIDE_RIGHT][1]));
	}
	const double spread = m ? stats_mad(m, ratio, stats_median(m, ratio)) : 0;
	free(ratio);
	// nor does it tell a turn below its own scatter
	return fmax(scatter, sqrt(fmax(0, spread * spread - scatter * scatter))) / per_radian;
}

void hold_settle(struct hold_known *known, double (*poses)[4][4], long n, const struct hold *h, bool rests)
{
	n = n < h->n ? n : h->n;
	double *y = mem_array((size_t)n + 1, sizeof *y), *x = mem_array((size_t)n + 1, sizeof *x), (*by)[MOTIONS] = mem_new((size_t)n + 1, sizeof *by);
	// lean and size first
	for (int k = MOTIONS - 1; k >= 0; k--) {
		const double unit = k < LEAN ? h->radius : 1;
		int seen = 0;
		for (long i = 0; i < n; i++) {
			double own[MOTIONS];
			y[i] = motion_of(own, h, &h->seen[i], by[i]) ? own[k] : NAN;
			seen += isfinite(y[i]);
		}
		if (seen < LEAST_FRAMES)
			continue;
		path(x, n, y, least[k] * unit, least_bend[k] * unit);
		memcpy(y, x, (size_t)n * sizeof *y);
		const double middle = rests ? stats_median((int)n, y) : 0;
		for (long i = 0; i < n; i++)
			by[i][k] = rests ? middle : x[i];
	}
	for (long i = 0; i < n; i++)
		moved(poses[i], h, by[i]);
	free(y);
	free(x);
	free(by);
	known->place_mm = n ? fmax(least[ACROSS] * h->radius, rests ? 0 : place_of(h, n)) * poses[0][2][3] / h->clip->camera.focal_px : 0;
	known->turn = turns_of(h, n);
}

void hold_pack(struct pack *p, struct hold *h, long first)
{
	long n = h->n;
	PACK(p, n);
	if (p->reading) {
		p->bad = p->bad || n < first || h->n != first || (size_t)(n - first) > p->n;
		if (p->bad)
			return;
		h->room = n + 256;
		h->seen = mem_grow(h->seen, (size_t)h->room, sizeof *h->seen);
	}
	if (n > first)
		pack_bytes(p, h->seen + first, (size_t)(n - first) * sizeof *h->seen);
	h->n = n;
	PACK(p, h->now);
	PACK(p, h->radius);
	PACK(p, h->lost_s);
}
