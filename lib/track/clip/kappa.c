#include "track/clip/kappa.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"
#include "math/vec.h"
#include "track/gaze/globe.h"

enum { LEAST = 5 };

/* Fick angles of a direction. */
static void fick_of(double out[2], const double d[3])
{
	out[0] = atan2(d[0], d[2]);
	out[1] = atan2(d[1], hypot(d[0], d[2]));
}

static double nasal(int side)
{
	return side == SIDE_LEFT ? -1 : 1;  // x is to the person's left
}

static void rotation_of(double R[3][3], const double gaze[3])
{
	const double fick[3] = { gaze[0], gaze[1], isfinite(gaze[2]) ? gaze[2] : 0 };
	gaze_rotation(R, fick);
}

void kappa_sight(double sight[2], const double gaze[3], const double kappa[2], int side)
{
	const double h = nasal(side) * kappa[0], v = kappa[1], in_eye[3] = { sin(h) * cos(v), sin(v), cos(h) * cos(v) };
	double R[3][3], d[3];
	rotation_of(R, gaze);
	mat_vec(d, R, in_eye);
	fick_of(sight, d);
}

/* The camera's direction against the optical axis of a frame. */
static void camera_from_axis(double out[2], const double pose[4][4], const double center[3], const double gaze[3], int side)
{
	double R[3][3], d[3], in_eye[3];
	for (int k = 0; k < 3; k++) {
		d[k] = -center[k];
		for (int i = 0; i < 3; i++)
			d[k] -= pose[i][k] * pose[i][3];
	}
	rotation_of(R, gaze);
	for (int k = 0; k < 3; k++)
		in_eye[k] = d[0] * R[0][k] + d[1] * R[1][k] + d[2] * R[2][k];
	fick_of(out, in_eye);
	out[0] *= nasal(side);
}

/* Brings one eye's prior together with the frames first..last. */
static void measure(struct track_kappa *k, const struct track_result *r, int side, long first, long last)
{
	const size_t room = (size_t)(last - first) + 2;
	double *x[2] = { mem_array(room, sizeof **x), mem_array(room, sizeof **x) }, *sigma[2] = { mem_array(room, sizeof **x), mem_array(room, sizeof **x) };
	int n = 0;
	for (long f = first; f <= last; f++) {
		const struct eye_state *s = &r->eyes.state[f][side];
		double off[2];
		if (r->lost_at[f] || s->blink != BLINK_OPEN || !isfinite(s->gaze[0] + s->gaze[1] + s->sigma[0] + s->sigma[1]))
			continue;
		camera_from_axis(off, r->pose[f], r->eyes.globe[side].center_in_head, s->gaze, side);
		for (int a = 0; a < 2; a++) {
			x[a][n] = off[a];
			sigma[a][n] = s->sigma[a];
		}
		n++;
	}
	for (int a = 0; a < 2 && n >= LEAST; a++) {
		const double got = stats_median(n, x[a]), off = stats_median(n, sigma[a]), all = 1 / (off * off) + 1 / (k->sigma[side][a] * k->sigma[side][a]);
		k->angle[side][a] = (got / (off * off) + k->angle[side][a] / (k->sigma[side][a] * k->sigma[side][a])) / all;
		k->sigma[side][a] = 1 / sqrt(all);
	}
	k->frames[side] = n >= LEAST ? n : 0;
	for (int a = 0; a < 2; a++) {
		free(x[a]);
		free(sigma[a]);
	}
}

bool track_kappa(struct track_result *r, const struct track_conf *conf, struct err *err)
{
	const double *at = conf->camera_frames;
	r->kappa = (struct track_kappa){ 0 };
	for (int e = 0; e < SIDES; e++)
		for (int a = 0; a < 2; a++) {
			r->kappa.angle[e][a] = conf->kappa[a] * M_PI / 180;
			r->kappa.sigma[e][a] = conf->kappa_sigma[a] * M_PI / 180;
		}
	if (isnan(at[0]))
		return true;
	if (!(at[0] >= 0 && at[1] >= at[0] && at[1] < (double)r->n && at[0] == floor(at[0]) && at[1] == floor(at[1])))
		return err_set(err, "track.camera_frames = %g %g: must be the first and the last of some frames of the video, in [0, %ld]", at[0], at[1], r->n - 1);
	for (int e = 0; e < SIDES && r->has_eyes; e++)
		if (r->eyes.globe[e].seen)
			measure(&r->kappa, r, e, (long)at[0], (long)at[1]);
	return true;
}
