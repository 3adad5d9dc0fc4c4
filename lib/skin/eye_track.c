#include "skin/eye_track.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "skin/eye_track_impl.h"

static bool known(int n, const double x[])
{
	for (int i = 0; i < n; i++)
		if (!isfinite(x[i]))
			return false;
	return true;
}

static void start(struct eye_side *eye, const struct eye_track *track, int side)
{
	const struct eye_prior *prior = &track->scene.prior[side];
	eye->scene = &track->scene;
	eye->conf = &track->conf;
	eye->prior = prior;
	eye->absent = prior->absent || !known(3, prior->center_in_head);
	memcpy(eye->globe.center, prior->center_in_head, sizeof eye->globe.center);
	eye->globe.radius = isfinite(prior->radius) && prior->radius > 3 ? prior->radius : 12;
	eye->globe.limbus = fmin(track->scene.eye.limbus_radius, 0.95 * eye->globe.radius);
	eye->first_globe = eye->globe;
	memcpy(eye->canthus, prior->canthus_in_head, sizeof eye->canthus);
	eye->torsion.rays = track->conf.torsion_rays < TORSION_RAYS_MAX ? track->conf.torsion_rays : TORSION_RAYS_MAX;
	lid_track_start(&eye->lids, track->conf.lid_columns, track->conf.lid_points);
}

struct eye_track *eye_track_new(const struct eye_scene *scene, const struct eye_track_conf *conf)
{
	struct eye_track *track = mem_new(1, sizeof *track);
	track->scene = *scene;
	track->conf = *conf;
	for (int side = 0; side < SIDES; side++)
		start(&track->side[side], track, side);
	return track;
}

const struct eye_state *eye_track_push(struct eye_track *track, int side, const struct eye_frame *frame)
{
	eye_side_push(&track->side[side], frame);
	return &track->side[side].last;
}

void eye_track_free(struct eye_track *track)
{
	if (!track)
		return;
	for (int side = 0; side < SIDES; side++) {
		free(track->side[side].state);
		free(track->side[side].record);
		free(track->side[side].kept);
		free(track->side[side].edge);
	}
	free(track);
}

static int earlier(const void *a, const void *b)
{
	const struct eye_event *x = a, *y = b;
	return x->first != y->first ? (x->first > y->first) - (x->first < y->first) : x->side - y->side;
}

bool eye_track_finish(struct eye_clip *clip, struct eye_track *track, struct err *err)
{
	*clip = (struct eye_clip){ .frames = (int)track->side[0].frames };
	for (int side = 0; side < SIDES; side++)
		if (track->side[side].frames < clip->frames)
			clip->frames = (int)track->side[side].frames;
	clip->state = mem_new((size_t)clip->frames, sizeof *clip->state);
	bool seen = false;
	for (int side = 0; side < SIDES; side++)
		eye_side_settle(&track->side[side]);
	eye_pair_level(&track->side[SIDE_LEFT], &track->side[SIDE_RIGHT]);
	for (int side = 0; side < SIDES; side++) {
		struct eye_side *eye = &track->side[side];
		eye_side_globe(&clip->globe[side], eye);
		if (clip->globe[side].seen)
			eye_side_events(clip, eye, side);
		for (int i = 0; i < clip->frames; i++)
			clip->state[i][side] = eye->state[i];
		seen |= clip->globe[side].seen;
	}
	if (clip->events)
		qsort(clip->event, (size_t)clip->events, sizeof *clip->event, earlier);
	if (!seen)
		return err_set(err, "no eye was found in any frame: film one or both eyes from near, lit from the front, open");
	return true;
}

void eye_clip_free(struct eye_clip *clip)
{
	free(clip->state);
	free(clip->event);
	*clip = (struct eye_clip){ 0 };
}
