#include "track/clip/hold.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"
#include "math/walk.h"
#include "track/clip/carry.h"

/* mm: the line through the corners of the eye lies lower on people than on the mean opening (subject.c): of heads of a model made from scans 2.2 +- 0.2 below the eyeballs'
 * centres, of that opening 0.5; between both. */
static const double LOWER = 0.9;
static const double OUTWARD = 0.8;     // mm: and the middle between them further to the temple, of those heads by 1.6, of that opening by none
static const double OPEN = 2;          // squares of the iris' radius: eyes that show less tell no corners
static const double AGREE = 0.8;       // radii: skin that tells the eyes so near to where they are is believed on the way
static const double LOST_S = 0.25;     // longer than most blinks
static const double WINK = 0.25;       // where one eye is told and the face was seen again, time counts for so much: the other eye winks
/* What lies otherwise than a frame before by more than this is no pair of this head's eyes: lean, radians; logarithm of the size. Heads turn by 300 degrees a second at most, and films have 25 frames. */
static const double LEAPS[2] = { 0.25, 0.2 };
static const double MOST[2] = { 0.7, 0.35 };  // and after a while, of one that was found in all of the picture
static const double NEAR = 0.5;        // eyes' distances: of a face that was seen again, the same
enum { ROUNDS = 6, LEAST_FRAMES = 12, BESIDE = 5 };
static const double UNSEEN = 8;        // times the noise of what is seen: so far off may be what is taken for it where it is not

static const double UNTOLD = 0.35;     // radians: how faces of a clip are turned, one standard deviation, where nothing tells

/* A similarity of the picture about the middle between the eyes: shift, px; lean, radians; logarithm of the size. And how the head is turned (head/turn.h), radians: first ASIDE. */
enum { ACROSS, DOWN, LEAN, SIZE, ASIDE, NOD, MOTIONS };
static const double follow_s[MOTIONS] = { 0.02, 0.02, 0.05, 0.2, 0.2, 0.2 };    // seconds over which each is followed on the way
static const double least[ASIDE] = { 0.03, 0.03, 0.005, 0.005 };      // radii of the iris, radians: scatter of a frame's, at least
static const double least_bend[ASIDE] = { 0.003, 0.003, 0.0005, 0.0003 };
/* How a head changes the speed of its turn, radians/s^1.5: a nod by 10 degrees and back in a second is one of 7 radians/s^2 for a quarter of one. The network errs alike in frames that are
 * alike, so that a clip does not show it. */
static const double turn_bend = 3;

/* carried: the shift that the face round the eyes tells alone. */
struct seen { float corner[SIDES][2][2], turn[TURNS], sigma[TURNS], unlike, carried[2]; bool known[SIDES], turned, is_carried; };

struct hold {
	const struct track_clip *clip;
	const struct track_subject *subject;
	double large_px;
	double lean;                   // of the reference, radians
	double begun[MOTIONS], now[MOTIONS];  // of the reference, and last
	double radius;                 // px, of the irises, last
	double lost_s, untold_s;       // since eyes were told, or looked for in all of the picture; since both were told
	bool carried;                  // the face round them was seen again in this frame
	struct carry carry;
	double seconds;                // of the frames kept
	long n, room;
	struct seen *seen;             // [n]
};

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

struct hold *hold_new(const struct track_clip *clip, const struct track_subject *subject, double large_px)
{
	struct hold *h = mem_new(1, sizeof *h);
	h->clip = clip;
	h->subject = subject;
	h->large_px = large_px;
	h->lost_s = h->untold_s = INFINITY;
	double at[3];
	middle_in(at, h, clip->cam_from_head);
	turn_of(h->begun + ASIDE, &h->lean, clip->cam_from_head, at);
	memcpy(h->now, h->begun, sizeof h->now);
	return h;
}

void hold_free(struct hold *h)
{
	if (h)
		free(h->seen);
	free(h);
}

/* The pose of a head that is turned so, the middle between its eyes there, mm. */
static void stand(double pose[4][4], const struct hold *h, const double turned[3][3], const double middle[3])
{
	double rest[3];
	for (int k = 0; k < 3; k++) {
		memcpy(pose[k], turned[k], sizeof turned[k]);
		pose[k][3] = 0;
	}
	middle_in(rest, h, (const double(*)[4])pose);
	for (int k = 0; k < 3; k++)
		pose[k][3] = middle[k] - rest[k];
}

/* The reference's pose so moved. */
static void moved(double pose[4][4], const struct hold *h, const double by[MOTIONS])
{
	const struct camera *camera = &h->clip->camera;
	double at[3], px[2], ray[3], turned[3][3];
	memcpy(pose, h->clip->cam_from_head, sizeof(double[4][4]));
	middle_in(at, h, h->clip->cam_from_head);
	if (!camera_project(px, camera, at))
		return;
	camera_ray(ray, camera, (double[2]){ px[0] + by[ACROSS], px[1] + by[DOWN] });
	turn_rotation(turned, by + ASIDE, h->lean + by[LEAN], ray);
	const double z = at[2] * exp(-by[SIZE]);
	for (int k = 0; k < 3; k++)
		at[k] = ray[k] / ray[2] * z;
	stand(pose, h, (const double(*)[3])turned, at);
}

double hold_turn_share(const struct track_subject *s)
{
	const double limbus_plane = 0.875;  // radii of the eyeball from its centre, of 12 and 5.85 mm
	double before = 0;
	int n = 0;
	for (int e = 0; e < SIDES; e++)
		for (int c = 0; c < 2 && s->opening[e].open; c++, n++)
			before += s->opening[e].canthus[c][2] - s->center[e][2];
	return fabs(1 - before / (fmax(1, n) * limbus_plane * s->radius));
}

/* Where a pose has the corners, px. */
static bool expected(double px[SIDES][2][2], const struct hold *h, const double pose[4][4])
{
	for (int e = 0; e < SIDES; e++)
		for (int c = 0; c < 2; c++) {
			const double *at = h->subject->opening[e].canthus[c];
			if (!head_project(px[e][c], &h->clip->camera, pose, (double[3]){ at[0] + (e == SIDE_LEFT ? OUTWARD : -OUTWARD), at[1] - LOWER, at[2] }))
				return false;
		}
	return true;
}

/* How the corners lie against those of the reference, turned as `about` is. Lids that close move the inner corners apart, alike in both eyes: their middle stays. One eye alone tells no lean and no size (NAN);
 * those of `about` are taken for it. Returns false where too little shows. */
static bool motion_of(double by[MOTIONS], const struct hold *h, const struct seen *s, const double about[MOTIONS])
{
	double px[SIDES][2][2], off[SIDES][2][2], told[SIDES][2], was[SIDES][2], pose[4][4];
	for (int k = 0; k < TURNS; k++)
		by[ASIDE + k] = s->turned ? (double)s->turn[k] : NAN;
	moved(pose, h, (const double[MOTIONS]){ [ASIDE] = about[ASIDE], [NOD] = about[NOD] });
	if (!(s->known[0] || s->known[1]) || !expected(px, h, (const double(*)[4])pose))
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

static struct seen seen_of(const struct eye_told *const told[SIDES], const struct head_turn *turn)
{
	struct seen s = { .turned = turn, .unlike = turn ? (float)turn->unlike : 0 };
	for (int k = 0; k < TURNS && turn; k++) {
		s.turn[k] = (float)turn->angle[k];
		s.sigma[k] = (float)turn->sigma[k];
	}
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

/* Whether what was found may be this head's eyes: as far apart, as level and near as the time since they were told lets them be. */
static bool may_be(const double by[MOTIONS], double apart, const struct hold *h)
{
	const double since = 1 + h->untold_s;
	if (!isfinite(h->untold_s))
		return true;
	if (fabs(by[SIZE] - h->now[SIZE]) > fmin(since * LEAPS[1], MOST[1]) || fabs(by[LEAN] - h->now[LEAN]) > fmin(since * LEAPS[0], MOST[0]))
		return false;
	return !h->carried || hypot(by[ACROSS] - h->now[ACROSS], by[DOWN] - h->now[DOWN]) < NEAR * since * apart;
}

void hold_found(struct hold *h, const double eye[SIDES][2])
{
	double px[SIDES][2], pose[4][4], by[MOTIONS];
	h->lost_s = 0;
	if (!eye)
		return;
	memcpy(by, h->now, sizeof by);
	by[ACROSS] = by[DOWN] = 0;
	moved(pose, h, (const double[MOTIONS]){ [ASIDE] = h->now[ASIDE], [NOD] = h->now[NOD] });
	for (int e = 0; e < SIDES; e++) {
		if (!head_project(px[e], &h->clip->camera, (const double(*)[4])pose, h->subject->opening[e].center))
			return;
		for (int k = 0; k < 2; k++)
			by[k] += 0.5 * (eye[e][k] - px[e][k]);
	}
	const double to[2] = { eye[0][0] - eye[1][0], eye[0][1] - eye[1][1] }, from[2] = { px[0][0] - px[1][0], px[0][1] - px[1][1] };
	by[LEAN] = atan2(from[0] * to[1] - from[1] * to[0], from[0] * to[0] + from[1] * to[1]);
	by[SIZE] = log(hypot(to[0], to[1]) / hypot(from[0], from[1]));
	if (may_be(by, hypot(to[0], to[1]), h))
		memcpy(h->now, by, sizeof by);
}

void hold_carry(struct hold *h, const uint8_t *luma, int stride)
{
	double shift[2];
	h->carried = isfinite(h->lost_s) && carry_find(shift, &h->carry, luma, stride, h->clip->info.width, h->clip->info.height);
	for (int k = 0; k < 2 && h->carried; k++)
		h->now[k] += shift[k];
}

void hold_keep(struct hold *h, const uint8_t *luma, int stride)
{
	double pose[4][4], px[SIDES][2];
	moved(pose, h, h->now);
	for (int e = 0; e < SIDES; e++)
		if (!head_project(px[e], &h->clip->camera, (const double(*)[4])pose, h->subject->opening[e].center))
			return;
	carry_keep(&h->carry, luma, stride, h->clip->info.width, h->clip->info.height, (const double[2]){ 0.5 * (px[0][0] + px[1][0]), 0.5 * (px[0][1] + px[1][1]) },
	           hypot(px[0][0] - px[1][0], px[0][1] - px[1][1]));
}

void hold_push(struct hold *h, const struct eye_told *const told[SIDES], const struct head_turn *turn, double radius, double dt, bool keep)
{
	struct seen seen = seen_of(told, turn);
	double by[MOTIONS];
	const bool any = motion_of(by, h, &seen, h->now);
	const bool leaps = keep && any && (fabs(by[LEAN] - h->now[LEAN]) > LEAPS[0] || fabs(by[SIZE] - h->now[SIZE]) > LEAPS[1]);
	const bool both = seen.known[0] && seen.known[1] && !leaps;
	h->lost_s = !keep ? INFINITY : both ? 0 : h->lost_s + dt * (h->carried && (seen.known[0] || seen.known[1]) ? WINK : 1);
	h->untold_s = !keep ? INFINITY : both ? 0 : h->untold_s + dt;
	if (leaps)
		seen.known[0] = seen.known[1] = seen.turned = false;
	for (int k = 0; k < MOTIONS && any && !leaps; k++)
		h->now[k] += isnan(by[k]) ? 0 : (dt > 0 ? 1 - exp(-dt / follow_s[k]) : 1) * (by[k] - h->now[k]);
	if (radius > 0)
		h->radius = radius;
	if (!keep)
		return;
	seen.is_carried = h->carried;
	for (int k = 0; k < 2; k++)
		seen.carried[k] = (float)h->now[k];
	h->seconds += dt;
	if (h->n == h->room)
		h->seen = mem_grow(h->seen, (size_t)(h->room = 2 * h->room + 256), sizeof *h->seen);
	h->seen[h->n++] = seen;
}

/* The median of the known ones that lie next to a gap, on one side of it. */
static double beside(const double *y, long n, long from, long step)
{
	double near[BESIDE];
	int m = 0;
	for (long i = from; i >= 0 && i < n && m < BESIDE; i += step)
		if (isfinite(y[i]))
			near[m++] = y[i];
	return m ? stats_median(m, near) : NAN;
}

/* What is taken for y where it is not known: a straight line between what lies on both sides. */
static void bridged(double *fill, long n, const double *y)
{
	for (long i = 0; i < n; i++) {
		long end = i;
		while (end < n && isnan(y[end]))
			end++;
		if (end == i)
			continue;
		const double before = beside(y, n, i - 1, -1), after = beside(y, n, end, 1), from = isnan(before) ? after : before, to = isnan(after) ? before : after;
		for (long k = i; k < end; k++)
			fill[k] = isnan(fill[k]) ? from + (to - from) * (double)(k - i + 1) / (double)(end - i + 1) : fill[k];
		i = end - 1;
	}
}

/* The path of y (NAN: not known) that goes on as it did but for changes of so much; what is far off by the noise counts little. Where y is not known long it does not go on for ever: fill
 * (NAN: where nothing tells) counts a little. x: overwritten. */
static void glide(double *x, long n, const double *y, double *fill, double noise, double bend)
{
	bridged(fill, n, y);
	double *sigma = mem_array((size_t)n + 1, sizeof *sigma), *room = mem_array(2 * (size_t)n + 1, sizeof *room);
	for (int round = 0; round < ROUNDS; round++) {
		for (long i = 0; i < n; i++) {
			const double off = round ? (y[i] - x[i]) / (3 * noise) : 0;
			sigma[i] = isfinite(y[i]) ? noise * sqrt(1 + off * off) : (isfinite(fill[i]) ? UNSEEN : 1e4) * noise;
			x[i] = isfinite(y[i]) ? y[i] : isfinite(fill[i]) ? fill[i] : 0;
		}
		walk_glide(n, x, sigma, bend, room);
	}
	free(sigma);
	free(room);
}

/* The same where the clip itself shows how it is measured and how it changes. */
static void path(double *x, long n, const double *y, double *fill, double noise_least, double bend_least)
{
	double *room = mem_array((size_t)n + 1, sizeof *room), noise, bend;
	walk_unrest(&noise, &bend, n, y, room);
	free(room);
	glide(x, n, y, fill, fmax(noise, noise_least), fmax(bend, bend_least));
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
		off[i] = NAN;
		apart[i] = s->known[0] && s->known[1] ? gap(s->corner[SIDE_LEFT][0], s->corner[SIDE_RIGHT][0]) : NAN;
	}
	path(middle, n, apart, off, 0.3 * h->radius, least_bend[SIZE] * h->radius);
	for (long i = 0; i < n; i++)
		if (isfinite(apart[i]))
			off[m++] = apart[i] - middle[i];
	const double sigma = m ? 0.5 * stats_mad(m, off, 0) : 0;
	free(apart);
	free(middle);
	free(off);
	return sigma;
}

/* What the network says as a rule of how well it knows a turn; TURNS: how unlike a face it is. NAN where it looked at few frames. */
static double usual(const struct hold *h, int which)
{
	double *told = mem_array((size_t)h->n + 1, sizeof *told);
	int m = 0;
	for (long i = 0; i < h->n; i++)
		if (h->seen[i].turned)
			told[m++] = (double)(which < TURNS ? h->seen[i].sigma[which] : h->seen[i].unlike);
	const double middle = m < LEAST_FRAMES ? NAN : stats_median(m, told);
	free(told);
	return middle;
}

double hold_unlike(const struct hold *h)
{
	return usual(h, TURNS);
}

void hold_settle(struct hold_known *known, double (*poses)[4][4], long n, const struct hold *h, bool rests)
{
	n = n < h->n ? n : h->n;
	double *y = mem_array((size_t)n + 1, sizeof *y), *x = mem_array((size_t)n + 1, sizeof *x), *fill = mem_array((size_t)n + 1, sizeof *fill), (*by)[MOTIONS] = mem_new((size_t)n + 1, sizeof *by);
	for (int k = 0; k < TURNS; k++) {
		known->turn[k] = usual(h, k);
		known->turn[k] = isnan(known->turn[k]) ? UNTOLD : known->turn[k];
	}
	for (long i = 0; i < n; i++)
		memcpy(by[i], h->begun, sizeof by[i]);
	// the turn first, then lean and size
	for (int k = MOTIONS - 1; k >= 0; k--) {
		const double unit = k < LEAN ? h->radius : 1;
		int seen = 0;
		for (long i = 0; i < n; i++) {
			double own[MOTIONS];
			y[i] = motion_of(own, h, &h->seen[i], by[i]) ? own[k] : NAN;
			fill[i] = k < LEAN && h->seen[i].is_carried ? (double)h->seen[i].carried[k] : NAN;
			seen += isfinite(y[i]);
		}
		if (seen < LEAST_FRAMES)
			continue;
		if (k < ASIDE)
			path(x, n, y, fill, least[k] * unit, least_bend[k] * unit);
		else
			glide(x, n, y, fill, known->turn[k - ASIDE], turn_bend * pow(h->seconds / (double)h->n, 1.5));
		memcpy(y, x, (size_t)n * sizeof *y);
		const double middle = rests ? stats_median((int)n, y) : 0;
		for (long i = 0; i < n; i++)
			by[i][k] = rests ? middle : x[i];
	}
	for (long i = 0; i < n; i++)
		moved(poses[i], h, by[i]);
	free(y);
	free(x);
	free(fill);
	free(by);
	known->place_mm = n ? fmax(least[ACROSS] * h->radius, rests ? 0 : place_of(h, n)) * poses[0][2][3] / h->clip->camera.focal_px : 0;
}

void hold_turn(double (*poses)[4][4], long n, const struct hold *h)
{
	n = n < h->n ? n : h->n;
	double *off[TURNS], by[TURNS], at[3], angle[TURNS], lean, m[3][3];
	int told = 0;
	for (int k = 0; k < TURNS; k++)
		off[k] = mem_array((size_t)n + 1, sizeof *off[k]);
	for (long i = 0; i < n; i++) {
		if (!h->seen[i].turned)
			continue;
		middle_in(at, h, (const double(*)[4])poses[i]);
		turn_of(angle, &lean, (const double(*)[4])poses[i], at);
		for (int k = 0; k < TURNS; k++)
			off[k][told] = (double)h->seen[i].turn[k] - angle[k];
		told++;
	}
	const bool enough = told >= LEAST_FRAMES;
	for (int k = 0; k < TURNS; k++) {
		by[k] = enough ? stats_median(told, off[k]) : 0;
		free(off[k]);
	}
	for (long i = 0; i < n && enough; i++) {
		middle_in(at, h, (const double(*)[4])poses[i]);
		turn_of(angle, &lean, (const double(*)[4])poses[i], at);
		turn_rotation(m, (const double[TURNS]){ angle[0] + by[0], angle[1] + by[1] }, lean, at);
		stand(poses[i], h, (const double(*)[3])m, at);
	}
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
	PACK(p, h->untold_s);
	PACK(p, h->carried);
	PACK(p, h->carry);
	PACK(p, h->seconds);
}
