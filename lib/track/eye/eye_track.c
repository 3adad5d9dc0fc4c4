#include "track/eye/eye_track.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "track/eye/eye_track_impl.h"

static bool known(int n, const double x[])
{
	for (int i = 0; i < n; i++)
		if (!isfinite(x[i]))
			return false;
	return true;
}

// mm: radius of an unknown eyeball; standard deviation of its guessed centre.
static const double RADIUS = 12, GUESS_SIGMA = 3;
// Grey levels taken for the step from iris to sclera before one was measured.
static const double CONTRAST = 60;

/* Without a mesh: the eyeball behind the limbus seen in the first frame, as if it looked into the camera. */
static void guess_center(struct eye_side *eye, const struct eye_scene *scene, const double limbus_px[3])
{
	const struct camera *camera = &scene->camera;
	double far = camera->focal_px * eye->globe.limbus / limbus_px[2], ray[3];
	camera_ray(ray, camera, limbus_px);
	eye->globe.center[0] = far * ray[0] / ray[2];
	eye->globe.center[1] = -far * ray[1] / ray[2];
	eye->globe.center[2] = -far - gaze_plane(&eye->globe);
	eye->center_guess = GUESS_SIGMA;
}

/* Corners of a usual opening, 28 mm wide, round the eyeball. */
static void guess_corners(struct eye_side *eye, int side)
{
	double size = eye->globe.radius / RADIUS, nose = side == SIDE_LEFT ? -1 : 1;
	for (int c = 0; c < 2; c++) {
		eye->canthus[c][0] = eye->globe.center[0] + (c ? -nose : nose) * 14 * size;
		eye->canthus[c][1] = eye->globe.center[1] + (c ? 0.5 : -1.5) * size;
		eye->canthus[c][2] = eye->globe.center[2] + 0.7 * eye->globe.radius;
	}
	eye->corners_guessed = true;
}

static void start(struct eye_side *eye, const struct eye_track *track, int side)
{
	const struct eye_prior *prior = &track->scene.prior[side];
	bool seen = known(3, prior->limbus_px) && prior->limbus_px[2] > 2, given = known(3, prior->center_in_head);
	eye->side = side;
	eye->scene = &track->scene;
	eye->conf = &track->conf;
	eye->absent = prior->absent || !(given || seen);
	eye->globe.radius = isfinite(prior->radius) && prior->radius > 3 ? prior->radius : RADIUS;
	eye->globe.limbus = fmin(prior->limbus > 0 ? prior->limbus : track->scene.eye.limbus_radius, 0.95 * eye->globe.radius);
	eye->center_guess = prior->center_sigma > 0 ? prior->center_sigma : track->conf.center_sigma;
	eye->average = prior->average;
	eye->radius_sigma = prior->average ? track->conf.free_radius[1] : track->conf.radius_sigma;
	memcpy(eye->view_sigma, prior->view_sigma, sizeof eye->view_sigma);
	eye->contrast = CONTRAST;
	if (given)
		memcpy(eye->globe.center, prior->center_in_head, sizeof eye->globe.center);
	else if (seen)
		guess_center(eye, &track->scene, prior->limbus_px);
	eye->first_globe = eye->globe;
	memcpy(eye->canthus, prior->canthus_in_head, sizeof eye->canthus);
	if (!known(6, &prior->canthus_in_head[0][0]))
		guess_corners(eye, side);
	eye->torsion.rays = track->conf.torsion_rays < TORSION_RAYS_MAX ? track->conf.torsion_rays : TORSION_RAYS_MAX;
	lid_track_start(&eye->lids, track->conf.lid_columns, track->conf.lid_points, track->conf.lid_wet, track->scene.fps);
}

/* Unknown focal length: as if the eye were a metre away. Unknown principal point: the middle of the picture. */
static void settle_camera(struct eye_scene *scene)
{
	struct camera *camera = &scene->camera;
	if (!known(2, camera->center_px)) {
		camera->center_px[0] = scene->width / 2.0;
		camera->center_px[1] = scene->height / 2.0;
	}
	for (int side = 0; side < SIDES && !isfinite(camera->focal_px); side++) {
		const struct eye_prior *prior = &scene->prior[side];
		if (!prior->absent && prior->limbus_px[2] > 2)
			camera->focal_px = 1000 * prior->limbus_px[2] / scene->eye.limbus_radius;
	}
	if (!isfinite(camera->focal_px))
		camera->focal_px = 2.0 * scene->width;
}

struct eye_track *eye_track_new(const struct eye_scene *scene, const struct eye_track_conf *conf)
{
	struct eye_track *track = mem_new(1, sizeof *track);
	track->scene = *scene;
	track->conf = *conf;
	settle_camera(&track->scene);
	for (int side = 0; side < SIDES; side++)
		start(&track->side[side], track, side);
	return track;
}

const struct eye_state *eye_track_push(struct eye_track *track, int side, const struct eye_frame *frame)
{
	eye_side_push(&track->side[side], frame);
	return &track->side[side].last;
}

void eye_track_learn(struct eye_track *track, int side, const struct eye_frame *frame)
{
	eye_side_learn(&track->side[side], frame);
}

void eye_track_head_was(struct eye_track *track, long frame, const double cam_from_head[4][4])
{
	for (int side = 0; side < SIDES; side++)
		if (frame < track->side[side].frames)
			memcpy(track->side[side].record[frame].cam_from_head, cam_from_head, sizeof track->side[side].record[frame].cam_from_head);
}

void eye_track_held(struct eye_track *track, double center_mm, double place_mm, const double turn[2])
{
	for (int side = 0; side < SIDES; side++) {
		track->side[side].center_guess = center_mm;
		track->side[side].place_sigma = place_mm;
		memcpy(track->side[side].turn_sigma, turn, sizeof track->side[side].turn_sigma);
	}
}

void eye_track_pack(struct pack *pack, struct eye_track *track, long first)
{
	for (int side = 0; side < SIDES; side++)
		eye_side_pack(pack, &track->side[side], first);
}

void eye_track_free(struct eye_track *track)
{
	if (!track)
		return;
	for (int side = 0; side < SIDES; side++) {
		bulk_free(track->scene.bulk, track->side[side].state);
		bulk_free(track->scene.bulk, track->side[side].record);
		bulk_free(track->scene.bulk, track->side[side].kept);
		bulk_free(track->scene.bulk, track->side[side].fine);
		bulk_free(track->scene.bulk, track->side[side].edge);
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
	*clip = (struct eye_clip){ .frames = (int)track->side[0].frames, .bulk = track->scene.bulk };
	for (int side = 0; side < SIDES; side++)
		if (track->side[side].frames < clip->frames)
			clip->frames = (int)track->side[side].frames;
	clip->state = bulk_new(clip->bulk, (size_t)clip->frames, sizeof *clip->state);
	bool seen = false;
	eye_pair_alike(&track->side[SIDE_LEFT], &track->side[SIDE_RIGHT], track->conf.alike_radius);
#pragma omp parallel for schedule(static, 1) num_threads(SIDES)
	for (int side = 0; side < SIDES; side++)
		eye_side_settle(&track->side[side]);
	eye_pair_level(&track->side[SIDE_LEFT], &track->side[SIDE_RIGHT]);
	eye_pair_doubt(&track->side[SIDE_LEFT], &track->side[SIDE_RIGHT], track->side[SIDE_LEFT].conf->apart, track->side[SIDE_LEFT].conf->poor);
	for (int side = 0; side < SIDES; side++) {
		struct eye_side *eye = &track->side[side];
		eye_side_globe(&clip->globe[side], eye);
		if (clip->globe[side].seen)
			eye_side_events(clip, eye, side);
		seen |= clip->globe[side].seen;
	}
	eye_pair_blinks(clip, track->side);
	for (int i = 0; i < clip->frames; i++)
		for (int side = 0; side < SIDES; side++)
			clip->state[i][side] = track->side[side].state[i];
	if (clip->events)
		qsort(clip->event, (size_t)clip->events, sizeof *clip->event, earlier);
	if (!seen)
		return err_set(err, "no eye was found in any frame: film one or both eyes from near, lit from the front, open");
	return true;
}

void eye_clip_free(struct eye_clip *clip)
{
	bulk_free(clip->bulk, clip->state);
	free(clip->event);
	*clip = (struct eye_clip){ 0 };
}
