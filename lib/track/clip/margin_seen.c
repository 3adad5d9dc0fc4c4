#include "track/clip/margin_seen.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "limbus/evidence.h"
#include "track/eye/told.h"

struct looker {
	const struct track_result *result;
	const struct track_clip *clip;
	const struct track_subject *subject;
	const struct track_conf *conf;
	struct evidence_net *net[SIDES];
	struct photo photo;        // what lies round the eyes
	uint8_t *rgb;
};

/* Middle and radius of an iris that looks straight on, px; false where that eye has no lids in the frame. */
static bool place_of(double place[3], const struct looker *l, int side, long frame)
{
	const double(*pose)[4] = l->result->pose[frame];
	const struct eye_opening *o = &l->subject->opening[side];
	double p[3];
	if (l->result->lost_at[frame] || !o->open || !isfinite(l->result->eyes.state[frame][side].lid[LID_UPPER][0][0])
	    || !head_project(place, &l->clip->camera, pose, o->center))
		return false;
	head_from(p, pose, o->center);
	place[2] = l->clip->camera.focal_px * l->conf->eye.limbus_radius / p[2];
	return place[2] > 1;
}

/* What the network is shown of an iris: 3.2 radii to all sides. */
static void show(struct looker *l, const struct video_frame *f, const double place[3])
{
	struct photo *photo = &l->photo;
	const double reach = 3.3 * place[2] + 2;
	int from[2], to[2];
	for (int k = 0; k < 2; k++) {
		const double size = k ? photo->height : photo->width;
		from[k] = (int)fmin(fmax(place[k] - reach, 0), size);
		to[k] = (int)fmin(fmax(place[k] + reach, 0), size);
	}
	video_frame_rgb(l->rgb, 3 * photo->width, f, from[0], from[1], to[0], to[1]);
	for (int y = from[1]; y < to[1]; y++)
		for (long i = 3 * ((long)y * photo->width + from[0]); i < 3 * ((long)y * photo->width + to[0]); i++)
			photo->rgb[i] = (uint16_t)(257 * l->rgb[i]);
}

static void keep(struct margin_seen *s, const struct evidence *e, const double place[3], const struct eye_state *state, double least_area)
{
	const double *from = state->lid[LID_UPPER][0], *to = state->lid[LID_UPPER][state->lid_points - 1];
	const double wide = fmax(1e-9, hypot(to[0] - from[0], to[1] - from[1])), across[2] = { (to[0] - from[0]) / wide, (to[1] - from[1]) / wide };
	struct eye_told told;
	if (e->width * e->height > MARGIN_SEEN_WIDE * MARGIN_SEEN_HIGH)
		return;
	s->known = true;
	s->radius = (float)place[2];
	s->x0 = (float)e->x0;
	s->y0 = (float)e->y0;
	s->scale = (float)e->scale;
	s->width = e->width;
	s->height = e->height;
	for (int i = 0; i < e->width * e->height; i++)
		s->eye[i] = (uint8_t)(255 * fminf(1, evidence_eye(e, i)) + 0.5F);
	s->ends = eye_told_of(&told, e, place, across) && told.area > least_area;
	for (int c = 0; c < 2 && s->ends; c++)
		for (int k = 0; k < 2; k++)
			s->corner[c][k] = (float)told.corner[c][k];
}

/* Both eyes of a frame. */
static bool look(struct margin_seen seen[SIDES], struct looker *l, const struct video_frame *f, long frame, struct err *err)
{
	double place[SIDES][3];
	bool in[SIDES], ok[SIDES];
	struct err each[SIDES] = { 0 };
	for (int e = 0; e < SIDES; e++) {
		seen[e].known = false;
		in[e] = place_of(place[e], l, e, frame);
		ok[e] = true;
		if (in[e])
			show(l, f, place[e]);
	}
#pragma omp parallel for schedule(static, 1)
	for (int e = 0; e < SIDES; e++) {
		struct evidence evidence;
		if (!in[e])
			continue;
		ok[e] = evidence_window(&evidence, l->net[e], &l->photo, place[e][0], place[e][1], place[e][2], &each[e]);
		if (!ok[e])
			continue;
		keep(&seen[e], &evidence, place[e], &l->result->eyes.state[frame][e], l->conf->canthi.least_area);
		evidence_free(&evidence);
	}
	for (int e = 0; e < SIDES; e++)
		if (!ok[e])
			*err = each[e];
	return ok[SIDE_LEFT] && ok[SIDE_RIGHT];
}

static bool frames(struct margin_seen (*seen)[SIDES], struct looker *l, int every, struct video *video, struct err *err)
{
	const long step = track_every(l->conf);
	bool ok = true, got = true;
	for (long n = 0; ok && got && n < l->result->n;) {
		struct video_frame f;
		ok = video_next(&f, &got, video, err);
		if (ok && got && f.index % step == l->clip->reference % step) {
			if (n % every == 0)
				ok = look(seen[n / every], l, &f, n, err);
			n++;
		}
		video_frame_free(&f);
	}
	return ok;
}

bool margin_seen_all(struct margin_seen (*seen)[SIDES], const struct track_result *result, int every, struct stage *stage, const struct track_clip *clip,
                     const struct track_subject *subject, const struct track_conf *conf, struct err *err)
{
	struct video_info info;
	const size_t pixels = (size_t)clip->info.width * (size_t)clip->info.height;
	struct looker l = { .result = result, .clip = clip, .subject = subject, .conf = conf, .photo = { .width = clip->info.width, .height = clip->info.height, .bits = 8 } };
	struct video *video = video_open(&info, stage_path(stage, "%s", clip->file), &conf->video, err);
	bool ok = video;
	for (int e = 0; e < SIDES && ok; e++)
		ok = evidence_open_shipped(&l.net[e], err);
	l.photo.rgb = mem_new(3 * pixels, sizeof *l.photo.rgb);
	l.rgb = mem_new(3 * pixels, 1);
	ok = ok && frames(seen, &l, every, video, err);
	free(l.rgb);
	free(l.photo.rgb);
	for (int e = 0; e < SIDES; e++)
		evidence_close(l.net[e]);
	video_close(video);
	return ok;
}

/* Chance of eye at x, y, bilinear, clamped to the border. */
static double chance(const struct margin_seen *s, double x, double y)
{
	const double u = fmin(fmax((x - (double)s->x0) / (double)s->scale - 0.5, 0), s->width - 1.001), v = fmin(fmax((y - (double)s->y0) / (double)s->scale - 0.5, 0), s->height - 1.001);
	const int i = (int)u, j = (int)v;
	const uint8_t *p = s->eye + j * s->width + i, *q = p + s->width;
	const double fu = u - i, top = p[0] + fu * (p[1] - p[0]), low = q[0] + fu * (q[1] - q[0]);
	return (top + (v - j) * (low - top)) / 255;
}

double margin_seen_edge(const struct margin_seen *s, const double p[2], const double out[2], double reach)
{
	const double half = 0.5, step = 0.4 * (double)s->scale;
	double best = NAN, before = chance(s, p[0] - reach * out[0], p[1] - reach * out[1]);
	for (double t = step - reach; t <= reach; t += step) {
		const double now = chance(s, p[0] + t * out[0], p[1] + t * out[1]);
		if (before >= half && now < half) {
			const double at = t - step * (half - now) / (before - now);
			best = isnan(best) || fabs(at) < fabs(best) ? at : best;
		}
		before = now;
	}
	return best;
}
