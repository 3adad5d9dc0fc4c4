#include "track/clip/canthi.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "limbus/evidence.h"
#include "math/vec.h"
#include "track/eye/told.h"

/* How far a corner of the mesh is to be moved, px, of one that the evidence has at `told`: the mean of both by their standard deviations, along the line between the corners and across
 * it; what is too far off is something else. radius: of the iris; mesh: variance of the mesh's, of it. */
static void move_of(double move[2], const double corner[2], const double told[2], int which, const double across[2], double radius, double mesh, const struct track_canthi_conf *conf)
{
	const double out = which ? 1 : -1, way[2][2] = { { out * across[0], out * across[1] }, { across[0] > 0 ? -across[1] : across[1], fabs(across[0]) } };
	const double d[2] = { told[0] - corner[0], told[1] - corner[1] };
	double off[2];
	for (int k = 0; k < 2; k++)
		off[k] = (d[0] * way[k][0] + d[1] * way[k][1]) / radius + conf->beyond[2 * which + k];
	const double most = hypot(off[0], off[1]) / conf->most, believed = 1 / (1 + pow(most, 4));
	move[0] = move[1] = 0;
	for (int k = 0; k < 2; k++) {
		const double share = believed * mesh / (mesh + pow(conf->told_sigma[2 * which + k], 2));
		for (int i = 0; i < 2; i++)
			move[i] += share * off[k] * radius * way[k][i];
	}
}

/* The same in the head, mm: at the corner's depth, parallel to the picture. */
static void in_head(double out[3], const double move[2], const double point[3], const struct track_clip *clip)
{
	double p[3];
	head_from(p, clip->cam_from_head, point);
	for (int k = 0; k < 3; k++)
		out[k] = p[2] / clip->camera.focal_px * (move[0] * clip->cam_from_head[0][k] + move[1] * clip->cam_from_head[1][k]);
}

/* Moves a corner, and the outline the less the further it is from it. */
static void carry(struct eye_opening *o, int which, const double move[3])
{
	static const double reach = 0.4;  // of the distance between the corners
	double from[3], apart = 0;
	memcpy(from, o->canthus[which], sizeof from);
	for (int k = 0; k < 3; k++)
		apart += pow(o->canthus[1][k] - o->canthus[0][k], 2);
	for (int i = 0; i < OPENING_POINTS; i++) {
		double d[3] = { o->edge[i][0] - from[0], o->edge[i][1] - from[1], o->edge[i][2] - from[2] };
		const double left = fmax(1 - vec_norm(d) / (reach * sqrt(apart)), 0);
		vec_add(o->edge[i], o->edge[i], left * left, move);
	}
	vec_add(o->canthus[which], o->canthus[which], 1, move);
}

/* Where the chance of eye falls below a half on the way from `place` past q; false: not within twice that way, or it is no eye half of the way to q. */
static bool outline_towards(double out[2], const struct evidence *e, const double place[3], const double q[2])
{
	const double d[2] = { q[0] - place[0], q[1] - place[1] }, step = 0.25 * e->scale / fmax(hypot(d[0], d[1]), 1e-9);
	double before = 0;
	for (double t = 0.5; t < 2; t += step) {
		const double p = (double)evidence_eye_at(e, place[0] + t * d[0], place[1] + t * d[1]);
		if (p < 0.5) {
			const double back = before > p ? step * (0.5 - p) / (before - p) : 0;
			for (int k = 0; k < 2; k++)
				out[k] = place[k] + (t - back) * d[k];
			return before > 0;
		}
		before = p;
	}
	return false;
}

/* How far the evidence's outline lies beyond each point of a margin on the way from `place`, of the iris' radius (NAN: it has none there), and those ways, px. Returns the
 * variance of the mesh's margin: what the two differ by besides the evidence's own error. Where that is nothing the mesh is as good (Efron and Morris 1973). */
struct apart { double off[OPENING_POINTS], way[OPENING_POINTS][2]; };

static double outline_apart(struct apart *a, const struct eye_opening *margin, const struct evidence *e, const double place[3], const struct track_clip *clip, const struct track_canthi_conf *conf)
{
	double sum = 0;
	int n = 0;
	for (int i = 0; i < OPENING_POINTS; i++) {
		double q[2], at[2];
		a->off[i] = NAN;
		if (!head_project(q, &clip->camera, clip->cam_from_head, margin->edge[i]) || !outline_towards(at, e, place, q))
			continue;
		const double far = fmax(hypot(q[0] - place[0], q[1] - place[1]), 1e-9);
		a->off[i] = 0;
		for (int k = 0; k < 2; k++) {
			a->way[i][k] = (q[k] - place[k]) / far;
			a->off[i] += (at[k] - q[k]) * a->way[i][k];
		}
		a->off[i] = a->off[i] / place[2] + conf->outline_beyond;
		sum += pow(fmin(fabs(a->off[i]), conf->most), 2);
		n++;
	}
	return n ? fmax(sum / n - pow(conf->outline_sigma, 2), 0) : pow(conf->mesh_sigma, 2);
}

/* Moves the points of a margin to the evidence's outline; each as its neighbours in the mean. What is too far off stays. */
static void to_outline(struct eye_opening *margin, const struct evidence *e, const double place[3], double mesh, const struct track_clip *clip, const struct track_canthi_conf *conf)
{
	enum { BESIDE = 2 };
	struct apart a;
	double by[OPENING_POINTS][3] = { { 0 } };
	const double share = mesh / (mesh + pow(conf->outline_sigma, 2));
	outline_apart(&a, margin, e, place, clip, conf);
	for (int i = 0; i < OPENING_POINTS; i++) {
		double move[2];
		if (isnan(a.off[i]))
			continue;
		for (int k = 0; k < 2; k++)
			move[k] = share / (1 + pow(a.off[i] / conf->most, 4)) * a.off[i] * place[2] * a.way[i][k];
		in_head(by[i], move, margin->edge[i], clip);
	}
	for (int i = 0; i < OPENING_POINTS; i++)
		for (int j = -BESIDE; j <= BESIDE; j++)
			vec_add(margin->edge[i], margin->edge[i], 1.0 / (2 * BESIDE + 1), by[(i + j + OPENING_POINTS) % OPENING_POINTS]);
}

static bool eye(struct track_subject *s, int side, struct evidence_net *net, const struct photo *photo, const struct track_clip *clip, const struct track_conf *conf, struct err *err)
{
	struct evidence seen;
	struct eye_told told;
	struct eye_opening *margin = &s->margin[side], *opening = &s->opening[side];
	double place[3], p[3], corner[2][2];
	if (!opening->open || !margin->open || !clip->eye_seen[side] || !head_project(place, &clip->camera, clip->cam_from_head, opening->center))
		return true;
	for (int c = 0; c < 2; c++)
		if (!head_project(corner[c], &clip->camera, clip->cam_from_head, margin->canthus[c]))
			return true;
	head_from(p, clip->cam_from_head, opening->center);
	place[2] = clip->camera.focal_px * conf->eye.limbus_radius / p[2];
	if (!evidence_window(&seen, net, photo, place[0], place[1], place[2], err))
		return false;
	const double wide = fmax(1e-9, hypot(corner[1][0] - corner[0][0], corner[1][1] - corner[0][1])), across[2] = { (corner[1][0] - corner[0][0]) / wide, (corner[1][1] - corner[0][1]) / wide };
	const bool known = eye_told_of(&told, &seen, place, across) && told.area > conf->canthi.least_area;
	struct apart unused;
	const double mesh = known ? outline_apart(&unused, margin, &seen, place, clip, &conf->canthi) : 0;
	for (int c = 0; c < 2 && known; c++) {
		double move[2], by[3];
		move_of(move, corner[c], told.corner[c], c, across, place[2], mesh, &conf->canthi);
		in_head(by, move, margin->canthus[c], clip);
		carry(margin, c, by);
		vec_add(opening->canthus[c], opening->canthus[c], 1, by);
	}
	s->margin_seen[side] = known;
	if (known)
		to_outline(margin, &seen, place, mesh, clip, &conf->canthi);
	evidence_free(&seen);
	return true;
}

bool track_canthi(struct track_subject *s, const struct track_clip *clip, const struct track_conf *conf, struct err *err)
{
	struct evidence_net *net = 0;
	if (s->assumed || !(conf->canthi.mesh_sigma > 0))
		return true;
	if (!evidence_open_shipped(&net, err))
		return false;
	struct photo photo = photo_of_bytes(clip->rgb, clip->info.width, clip->info.height);
	bool ok = true;
	for (int e = 0; e < SIDES && ok; e++)
		ok = eye(s, e, net, &photo, clip, conf, err);
	free(photo.rgb);
	evidence_close(net);
	return ok;
}
