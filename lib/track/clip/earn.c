#include "track/clip/earn.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "track/clip/moves.h"
#include "track/head/find.h"
#include "track/head/propose.h"
#include "track/head/rigid.h"

enum { LOOKS = 6 };

/* A reference turned so much further from the camera than another frame is exchanged for it: the skin of its far side is soon out of sight. So is one that shows an
 * expression: all others would be off it; a millimetre counts as so many degrees. Among frames so much alike the most open eyes decide. degrees, assumptions. */
static const double turned_off = 10, stirred_deg = 15, alike = 6;

struct look {
	long frame;
	struct head_eyes eyes;
	double worth;
};

/* Eyes in those frames, in rising order; returns how many frames show two. */
static int look_at(struct look out[LOOKS], int frames, const long frame[LOOKS], const struct track_clip *clip, struct evidence_net *net, struct stage *stage,
                   const struct track_conf *conf)
{
	struct video_info info;
	struct err none = { 0 };
	struct video *video = video_open(&info, stage_path(stage, "%s", clip->file), &conf->video, &none);
	uint8_t *rgb = mem_array(3 * (size_t)clip->info.width * (size_t)clip->info.height + 1, 1);
	bool got = video;
	int n = 0;
	for (long i = 0, k = 0; got && k < frames; i++) {
		struct video_frame f;
		got = video_next(&f, &got, video, &none) && got;
		if (got && i == frame[k]) {
			while (k < frames && frame[k] == i)
				k++;
			video_frame_rgb(rgb, 3 * f.width, &f, 0, 0, f.width, f.height);
			out[n].frame = i;
			n += head_propose(&out[n].eyes, net, rgb, f.width, f.height, &none);
		}
		video_frame_free(&f);
	}
	video_close(video);
	free(rgb);
	return n;
}

/* Eyes in frames spread over the span. */
static int look(struct look out[LOOKS], long span, const struct track_clip *clip, struct evidence_net *net, struct stage *stage, const struct track_conf *conf)
{
	long frame[LOOKS];
	for (int k = 0; k < LOOKS; k++)
		frame[k] = (2 * k + 1) * span / (2 * LOOKS);
	return look_at(out, LOOKS, frame, clip, net, stage, conf);
}

/* The frame whose eyes are furthest apart for their size, most open and most certain. */
static const struct look *best_of(struct look *looks, int n)
{
	double radius = 0;
	const struct look *best = looks;
	for (int i = 0; i < n; i++)
		radius += looks[i].eyes.radius / n;
	for (int i = 0; i < n; i++) {
		const double(*e)[2] = (const double(*)[2])looks[i].eyes.eye;
		// an iris' size is told worse than the eyes' distance
		looks[i].worth = hypot(e[0][0] - e[1][0], e[0][1] - e[1][1]) / sqrt(radius * looks[i].eyes.radius) * pow(looks[i].eyes.score, 2) * looks[i].eyes.open;
		best = looks[i].worth > best->worth ? &looks[i] : best;
	}
	return best;
}

/* Takes the frame and lays a head that faces the camera on its eyes. */
static bool lay(struct track_clip *clip, const struct look *look, struct stage *stage, const struct track_subject *s, const struct track_conf *conf)
{
	struct head_found found;
	struct err none = { 0 };
	if (!head_find_from_eyes(&found, (const double(*)[2])look->eyes.eye, &clip->camera, s->opening)
	    || (look->frame != clip->reference && !track_clip_take(clip, look->frame, stage, conf, &none)))
		return false;
	memcpy(clip->cam_from_head, found.cam_from_head, sizeof clip->cam_from_head);
	clip->eye_seen[0] = clip->eye_seen[1] = true;
	return true;
}

static long span_of(const struct track_clip *clip, const struct track_conf *conf)
{
	long span = track_frames_of(clip, conf->doubt.span);
	return span < clip->info.frames ? span : clip->info.frames;
}

/* A head on a rest tells nothing by its skin; seen in a tenth of a second's steps, under the pose that was found first. */
static bool rests(const struct track_clip *clip, struct stage *stage, const struct track_subject *s, const struct track_conf *conf)
{
	struct track_moves moves;
	bool is = track_moves(&moves, track_frames_of(clip, 6), span_of(clip, conf), clip, stage, s, conf) && track_moves_rest(&moves, clip, s);
	track_moves_free(&moves);
	return is;
}

/* How far the face looks away from the camera, degrees. */
static double aside(const double cam_from_head[4][4], const struct track_subject *s)
{
	double eyes[3], at[3], out[3];
	for (int k = 0; k < 3; k++) {
		eyes[k] = 0.5 * (s->opening[0].center[k] + s->opening[1].center[k]);
		out[k] = -cam_from_head[k][2];
	}
	head_from(at, cam_from_head, eyes);
	return acos(fmin(1, vec_dot(at, out) / vec_norm(at))) * 180 / M_PI;
}

/* How little each known frame suits as the reference, degrees: how far it is turned, and how far its skin is from where it mostly lies. Returns the least. */
static double unsuited(double *cost, const struct track_clip *clip, const struct track_subject *s, const struct track_conf *conf)
{
	const struct track_moves *m = &clip->moves;
	double least = INFINITY;
	track_moves_stirred(cost, m, clip, s, conf);
	for (int i = 0; i < m->n_known; i++) {
		cost[i] = aside((const double(*)[4])m->known[i].cam_from_head, s) + (isnan(cost[i]) ? turned_off : stirred_deg * cost[i]);
		least = fmin(least, cost[i]);
	}
	return least;
}

/* Takes the frame that suits best of those whose pose the skin told, its eyes open, and that pose. Returns false, nothing changed, where the reference is
 * hardly worse. */
static bool take_suited(struct track_clip *clip, struct evidence_net *net, struct stage *stage, const struct track_subject *s, const struct track_conf *conf)
{
	const struct track_moves *m = &clip->moves;
	struct look looks[LOOKS];
	struct err none = { 0 };
	double cost[RIGID_KNOWN], least = unsuited(cost, clip, s, conf), here = INFINITY;
	long frame[LOOKS], front[RIGID_KNOWN], away = LONG_MAX;
	int n = 0;
	for (int i = 0; i < m->n_known; i++) {
		// of few frames the pose is told; the one next to the reference stands for it
		if (labs(m->known[i].frame - clip->reference) < away) {
			away = labs(m->known[i].frame - clip->reference);
			here = cost[i];
		}
		if (cost[i] < least + alike)
			front[n++] = i;
	}
	if (!n || here < least + turned_off)
		return false;
	const int looked = n < LOOKS ? n : LOOKS;
	for (int k = 0; k < looked; k++)
		frame[k] = m->known[front[k * n / looked]].frame;
	const int seen = look_at(looks, looked, frame, clip, net, stage, conf);
	const long best = seen ? best_of(looks, seen)->frame : -1;
	for (int i = 0; i < m->n_known; i++)
		if (m->known[i].frame == best && track_clip_take(clip, best, stage, conf, &none)) {
			memcpy(clip->cam_from_head, m->known[i].cam_from_head, sizeof clip->cam_from_head);
			return true;
		}
	return false;
}

static bool earn(struct track_clip *clip, struct evidence_net *net, struct stage *stage, const struct track_subject *s, const struct track_conf *conf)
{
	enum { AGAIN = 2, TURNS = 3 };
	struct look looks[LOOKS];
	const long span = span_of(clip, conf);
	int n = look(looks, span, clip, net, stage, conf);
	if (!n || !lay(clip, best_of(looks, n), stage, s, conf))
		return false;
	bool told = true, moved = false;
	for (int again = 0, turns = 0; told && again < AGAIN;) {
		struct track_moves moves;
		track_moves_free(&clip->moves);
		told = track_moves(&moves, clip->info.fps > 40 ? track_frames_of(clip, 2) : 1, span, clip, stage, s, conf);
		clip->moves = moves;
		// once more where points were chosen under a pose that was far off, or in a frame that is turned aside or shows an expression
		double was[4][4], d[6], none[3] = { 0 };
		memcpy(was, clip->cam_from_head, sizeof was);
		told = told && track_moves_pose(clip, &clip->moves, s, moved, conf);
		head_motion(d, clip->cam_from_head, was, none);
		moved = moved || told;
		if (told && turns < TURNS && take_suited(clip, net, stage, s, conf)) {
			turns++;
			continue;
		}
		again++;
		if (hypot(d[0], d[1]) < 0.1)
			break;
	}
	return moved;
}

bool track_earn(struct track_clip *clip, struct stage *stage, const struct track_subject *s, const struct track_conf *conf, struct err *err)
{
	struct evidence_net *net = 0;
	if (conf->reference >= 0 || !s->mesh.n_vertices || !s->opening[0].open || !s->opening[1].open || rests(clip, stage, s, conf) || !evidence_open_shipped(&net, err))
		return false;
	struct track_clip was = *clip;
	size_t area = (size_t)clip->info.width * (size_t)clip->info.height;
	clip->luma = mem_array(area + 1, 1);
	clip->rgb = mem_array(3 * area + 1, 1);
	memcpy(clip->luma, was.luma, area);
	memcpy(clip->rgb, was.rgb, 3 * area);
	bool ok = earn(clip, net, stage, s, conf);
	evidence_close(net);
	struct track_clip *drop = ok ? &was : clip;
	const double turned = clip->moves.turned;
	free(drop->luma);
	free(drop->rgb);
	if (!ok) {
		track_moves_free(&clip->moves);
		*clip = was;
		clip->moves.turned = turned;  // too little to tell its pose, but it is not at rest
	}
	return ok;
}

bool track_propose(struct track_clip *clip, struct stage *stage, const struct track_subject *s, const struct track_conf *conf, struct err *err)
{
	struct evidence_net *net = 0;
	struct look looks[LOOKS];
	if (!s->opening[0].open || !s->opening[1].open || !evidence_open_shipped(&net, err))
		return false;
	int n = look(looks, span_of(clip, conf), clip, net, stage, conf);
	evidence_close(net);
	return n && lay(clip, best_of(looks, n), stage, s, conf);
}
