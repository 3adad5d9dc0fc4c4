#include "track/clip/trust.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/stats.h"
#include "track/clip/scale.h"
#include "track/head/refine.h"
#include "track/head/turn.h"

enum { LEAST = 12 };

const struct trust_name trust_names[TRUST_EVIDENCES] = {
	[TRUST_LAID] = { "laid_px", "lids and eyeballs of the reference off the mesh", "px", "give subject.eye_center.left and .right, or a frame from in front (track.reference_frame)" },
	[TRUST_SKIN] = { "skin_mm", "skin off the head that was followed", "mm", "check camera.focal_px, or give another track.reference_frame" },
	[TRUST_LEVEL] = { "level_deg", "one eye looking higher than the other", "degrees", "give subject.eye_center.left and .right, or another track.reference_frame" },
	[TRUST_APART] = { "apart_deg", "eyes looking apart, or on what is nearer than people look,", "degrees", "check camera.focal_px, give subject.eye_center.left and .right, or another track.reference_frame" },
	[TRUST_IRIS] = { "iris_mm", "radius of the irises off people's", "mm", "check subject.unit_mm, or give another track.reference_frame" },
	[TRUST_SCALE] = { "scale_mm", "radius of the irises, by the eyes' distance or width, off people's", "mm", "give another track.reference_frame" },
	[TRUST_UNLIKE] = { "unlike_deg", "how the face is turned not to be told, but", "degrees", "film from in front, in even light" },
	[TRUST_TURNED] = { "turned_deg", "mesh turned otherwise than the face looks,", "degrees", "give another track.reference_frame" },
	[TRUST_STRAIGHT] = { "straight_deg", "gaze off straight ahead", "degrees", "give another track.reference_frame" },
};

/* Median over the frames in which it is known, NAN where those are few. Clobbers x. */
static double middle_of(int n, double *x)
{
	return n >= LEAST ? stats_median(n, x) : NAN;
}

/* Median of how much the left eye looks further along the axis than the right one (sum false), or of the mean of the eyes seen, degrees. */
static double gaze_of(const struct track_result *r, int axis, bool sum)
{
	double *d = mem_array((size_t)r->n + 1, sizeof *d);
	int n = 0;
	for (long f = 0; f < r->n && r->has_eyes; f++) {
		double left = r->eyes.state[f][SIDE_LEFT].gaze[axis], right = r->eyes.state[f][SIDE_RIGHT].gaze[axis];
		left = sum && !r->eyes.globe[SIDE_LEFT].seen ? right : left;
		right = sum && !r->eyes.globe[SIDE_RIGHT].seen ? left : right;
		if (!r->lost_at[f] && isfinite(left + right))
			d[n++] = (sum ? 0.5 * (left + right) : left - right) * 180 / M_PI;
	}
	double middle = middle_of(n, d);
	free(d);
	return middle;
}

/* How much further the eyes diverge, or converge, than on what lies between the horizon and the camera, or what people read where the camera is nearer, degrees.
 * The left eye's x is the greater. */
static double apart_of(const struct track_result *r, const struct track_clip *clip, double nearest_mm)
{
	const double *left = r->eyes.globe[SIDE_LEFT].center_in_head, *right = r->eyes.globe[SIDE_RIGHT].center_in_head, *to_camera = clip->cam_from_head[2];
	double apart = gaze_of(r, 0, false), away = to_camera[3];
	for (int k = 0; k < 3; k++)
		away += 0.5 * to_camera[k] * (left[k] + right[k]);
	const double near = -atan2(fmax(0, left[0] - right[0]), fmax(nearest_mm, away)) * 180 / M_PI;
	return apart > 0 ? apart : apart < near ? near - apart : isnan(apart) ? NAN : 0;
}

double trust_skin_mm(const struct track_result *r, const struct track_clip *clip, const struct track_subject *s)
{
	double *off = mem_array((size_t)r->n + 1, sizeof *off);
	int n = 0;
	for (long f = 0; f < r->n && r->misfit; f++)
		if (!r->lost_at[f])
			off[n++] = r->misfit[f] / track_px_per_mm(clip, (const double(*)[4])r->pose[f], s);
	double middle = middle_of(n, off);
	free(off);
	return middle;
}

/* Mean of the limbi's radii less people's, mm. */
static double iris_of(const struct track_result *r, double usual)
{
	double off = 0;
	int n = 0;
	for (int e = 0; e < SIDES && r->has_eyes; e++)
		if (r->eyes.globe[e].seen) {
			off += r->eyes.globe[e].limbus_radius - usual;
			n++;
		}
	return n ? off / n : NAN;
}

/* Probability that gaze is off by more than `most` (degrees) in an axis of an eye, by its own standard deviation, as far as a clip's 95 % error tells: most of it (the
 * eyeball's, the pose's) is in all frames alike, and what the eyeball's radius makes of it grows with the gaze. */
static double far_of(const struct track_result *r, double most)
{
	double *sigma = mem_array((size_t)r->n + 1, sizeof *sigma), far = 0;
	for (int k = 0; k < 2 * SIDES && r->has_eyes; k++) {
		int n = 0;
		for (long f = 0; f < r->n; f++) {
			const struct eye_state *s = &r->eyes.state[f][k / 2];
			if (!r->lost_at[f] && isfinite(s->gaze[k % 2] + s->sigma[k % 2]))
				sigma[n++] = s->sigma[k % 2] * 180 / M_PI;
		}
		const double large = n >= LEAST ? stats_quantile(n, sigma, 0.95) : NAN;
		far = large > 0 ? fmax(far, erfc(most / (sqrt(2) * large))) : far;
	}
	free(sigma);
	return far;
}

/* Density of a normal distribution about 0, less the constant. */
static double normal(double x, double scale)
{
	return exp(-0.5 * (x / scale) * (x / scale)) / scale;
}

/* own: standard deviation of the value itself. */
static double odds_of(int evidence, double x, double own, const struct track_conf *conf)
{
	const double scale[2] = { hypot(conf->trust[evidence][0], own), hypot(conf->trust[evidence][1], own) }, odd = conf->trust_odd;
	if (isnan(x))
		return 0;
	// so far off that both densities vanish
	const double far = 8 * scale[1], right = normal(fmin(fabs(x), far), scale[0]), wrong = normal(fmin(fabs(x), far), scale[1]);
	return log(((1 - odd) * right + odd * wrong) / (0.5 * (right + wrong)));
}

double trust_odds(int evidence, double x, const struct track_conf *conf)
{
	return odds_of(evidence, x, 0, conf);
}

/* Median standard deviation of an eye's gaze, degrees; NAN with few frames. */
static double sigma_of(const struct track_result *r, int side, int axis)
{
	double *sigma = mem_array((size_t)r->n + 1, sizeof *sigma);
	int n = 0;
	for (long f = 0; f < r->n && r->has_eyes; f++)
		if (isfinite(r->eyes.state[f][side].sigma[axis]))
			sigma[n++] = r->eyes.state[f][side].sigma[axis] * 180 / M_PI;
	const double middle = middle_of(n, sigma);
	free(sigma);
	return middle;
}

/* What outlines are off by in any picture, as laid_px counts. */
static double outline_of(const struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf)
{
	return conf->outline / trust_scale(clip, s);
}

/* Of one eye's gaze against the other's, or of their mean, as they say: where corners hold the head and average eyeballs lie between them. */
static double own_of(const struct track_result *r, int evidence)
{
	const bool of_gaze = evidence == TRUST_APART || evidence == TRUST_LEVEL || evidence == TRUST_STRAIGHT;
	if (!(r->place_mm > 0) || !of_gaze)
		return 0;
	const double left = sigma_of(r, SIDE_LEFT, evidence == TRUST_LEVEL), right = sigma_of(r, SIDE_RIGHT, evidence == TRUST_LEVEL);
	const double both = hypot(isnan(left) ? 0 : left, isnan(right) ? 0 : right);
	return evidence == TRUST_STRAIGHT ? 0.5 * both : both;
}

double trust_sigma_deg(const struct track_result *r)
{
	double worst = NAN;
	for (int k = 0; k < 2 * SIDES; k++)
		worst = fmax(worst, sigma_of(r, k / 2, k % 2));
	return worst;
}

double trust_wrong_deg(const struct track_subject *s, const struct track_conf *conf)
{
	return s->assumed ? conf->wrong_alone_deg : conf->wrong_deg;
}

/* Probability that the focal length told is wrong (Bayes' rule): the share of perspective seen is normal about 1, and about as much as people mistake lenses for. No
 * other evidence speaks for a lens: it is weighed by itself. One that nothing tells of is believed. */
static double lens_of(const struct track_clip *clip, const struct track_conf *conf)
{
	if (clip->focal_assumed || !(clip->lens.sigma > 0))
		return 0;
	const double off = clip->lens.share - 1, prior = conf->wrong_lens_prior, own = hypot(clip->lens.sigma, conf->lens_share[0]), far = 30 * own;
	const double as_told = (1 - prior) * normal(fmin(fabs(off), far), own), mistaken = prior * normal(fmin(fabs(off), far), hypot(own, conf->lens_share[1]));
	return mistaken / (as_told + mistaken);
}

double trust_scale(const struct track_clip *clip, const struct track_subject *s)
{
	return head_find_scale(clip->info.width, &clip->camera, clip->cam_from_head, s->opening) * (clip->pose_refined ? 1 : 2);
}

double trust_reference(const struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf)
{
	return isnan(clip->pose_px) ? -INFINITY : odds_of(TRUST_LAID, clip->pose_px / trust_scale(clip, s), outline_of(clip, s, conf), conf) + trust_odds(TRUST_SKIN, clip->skin_mm, conf);
}

/* Whether the mesh was laid on by the opening of one eye whose centre was not told. */
static bool laid_by_one(const struct track_result *r, const struct track_subject *s)
{
	const bool left = r->eyes.globe[SIDE_LEFT].seen;
	return r->has_eyes && left != r->eyes.globe[SIDE_RIGHT].seen && !s->center_given[left ? SIDE_LEFT : SIDE_RIGHT];
}

/* How far the reference's pose is turned from what its face looks like, degrees, and what that is known to; NAN where it does not show both eyes. */
static double turned_of(double *sigma, const struct track_clip *clip, const struct track_subject *s)
{
	const double degree = M_PI / 180;
	struct turn_net *net;
	struct err none = { 0 };
	struct head_turn seen;
	double middle[SIDES][2], between[3], at[3], angle[TURNS], lean;
	*sigma = 0;
	if (!clip->rgb || !clip->eye_seen[0] || !clip->eye_seen[1] || !track_eyes_middle(middle, &clip->camera, clip->cam_from_head, s))
		return NAN;
	track_eyes_between(between, s);
	// a network that does not run says so where a video alone is begun
	if (!turn_open_shipped(&net, &none))
		return NAN;
	const bool ok = turn_see(&seen, net, clip->rgb, clip->info.width, clip->info.height, (const double(*)[2])middle, &none);
	turn_close(net);
	if (!ok)
		return NAN;
	head_from(at, clip->cam_from_head, between);
	turn_of(angle, &lean, clip->cam_from_head, at);
	*sigma = sqrt(0.5) * hypot(seen.sigma[0], seen.sigma[1]) / degree;
	return hypot(angle[TURN_ASIDE] - seen.angle[TURN_ASIDE], angle[TURN_NOD] - seen.angle[TURN_NOD]) / degree;
}

void track_trust(struct track_trust *t, const struct track_result *r, const struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf)
{
	const bool laid = !s->assumed && !clip->pose_given && !clip->moves.turned;
	t->value[TRUST_LAID] = laid ? clip->pose_px / trust_scale(clip, s) : NAN;
	t->value[TRUST_SKIN] = r->place_mm > 0 ? NAN : trust_skin_mm(r, clip, s);
	t->value[TRUST_LEVEL] = gaze_of(r, 1, false);
	t->value[TRUST_APART] = apart_of(r, clip, conf->nearest_mm);
	t->value[TRUST_IRIS] = s->assumed ? NAN : iris_of(r, conf->eye.limbus_radius);
	t->value[TRUST_SCALE] = s->assumed ? iris_of(r, conf->eye.limbus_radius) : NAN;
	t->value[TRUST_STRAIGHT] = hypot(gaze_of(r, 0, true), gaze_of(r, 1, true));
	double own[TRUST_EVIDENCES];
	for (int i = 0; i < TRUST_EVIDENCES; i++)
		own[i] = own_of(r, i);
	own[TRUST_LAID] = laid ? outline_of(clip, s, conf) : 0;
	own[TRUST_SCALE] = s->assumed && r->n ? conf->eyes.edge_px / track_px_per_mm(clip, (const double(*)[4])r->pose[0], s) : 0;
	t->value[TRUST_UNLIKE] = s->assumed && r->unlike > 0 ? r->unlike * 180 / M_PI : NAN;
	t->value[TRUST_TURNED] = s->assumed ? NAN : turned_of(&own[TRUST_TURNED], clip, s);
	const double prior = laid && laid_by_one(r, s) ? conf->wrong_prior_one : conf->wrong_prior;
	double odds = log((1 - prior) / prior);
	for (int i = 0; i < TRUST_EVIDENCES; i++)
		odds += t->log_odds[i] = odds_of(i, t->value[i], own[i], conf);
	t->far = far_of(r, trust_wrong_deg(s, conf));
	t->lens = lens_of(clip, conf);
	t->wrong = 1 - (1 - t->far) * (1 - t->lens) / (1 + exp(-odds));
}
