#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "track/eye/eye_track_impl.h"

// Seconds for which a hidden gaze is assumed to be near its last direction.
static const double LOST_S = 1;
static const double OPEN = 2.5;        // squares of the limbus' radius: eyes that show so much are open
static const double DENIED_S = 0.2;

static bool to_pixel(double px[2], const struct gaze_view *view, const double p[3])
{
	double cam[3];
	for (int i = 0; i < 3; i++) {
		cam[i] = view->cam_from_head[i][3];
		for (int k = 0; k < 3; k++)
			cam[i] += view->cam_from_head[i][k] * p[k];
	}
	return camera_project(px, &view->camera, cam);
}

/* Mean change of brightness since the last frame that was measured, on a grid round the eye. */
static double change(struct eye_side *eye, const struct luma *luma, const double center[2], double radius)
{
	uint8_t now[EYE_STILL_SIDE * EYE_STILL_SIDE];
	long sum = 0;
	for (int j = 0; j < EYE_STILL_SIDE; j++) {
		for (int i = 0; i < EYE_STILL_SIDE; i++) {
			double x = center[0] + (i - EYE_STILL_SIDE / 2 + 0.5) * 4 * radius / EYE_STILL_SIDE;
			double y = center[1] + (j - EYE_STILL_SIDE / 2 + 0.5) * 3 * radius / EYE_STILL_SIDE;
			now[j * EYE_STILL_SIDE + i] = (uint8_t)luma_at(luma, x, y);
		}
	}
	for (int k = 0; k < EYE_STILL_SIDE * EYE_STILL_SIDE; k++)
		sum += abs(now[k] - eye->still[k]);
	double mean = (double)sum / (EYE_STILL_SIDE * EYE_STILL_SIDE);
	if (!(mean < eye->conf->still))
		memcpy(eye->still, now, sizeof now);
	return mean;
}

static struct eye_state blank(double time)
{
	struct eye_state state = { .time = time, .openness = NAN };
	for (int k = 0; k < 3; k++)
		state.gaze[k] = state.sigma[k] = NAN;
	for (int k = 0; k < 5; k++)
		state.limbus[k] = NAN;
	for (int k = 0; k < LIDS * LID_POINTS_MAX; k++)
		state.lid[k / LID_POINTS_MAX][k % LID_POINTS_MAX][0] = state.lid[k / LID_POINTS_MAX][k % LID_POINTS_MAX][1] = NAN;
	return state;
}

void eye_fill_lids(struct eye_state *state, const struct lid_found *found, int points)
{
	state->lid_points = points;
	for (int q = 0; q < LIDS; q++) {
		state->lid_confidence[q] = found->clear[q] * fmin(1, fmax(0, found->sense / 2));
		for (int k = 0; k < points; k++)
			memcpy(state->lid[q][k], found->p[q][k], sizeof(double[2]));
	}
}

/* Replaces guessed corners by the ends of the opening just found, and restarts the lids with them. */
static bool find_corners(struct eye_side *eye, struct eye_record *record, const struct lid_picture *picture,
                         struct lid_look *look, const struct gaze_view *view)
{
	if (!record->found.open)
		return true;
	for (int c = 0; c < 2; c++) {
		double cam[3], ray[3], at[3];
		const struct lid_curves *m = &eye->lids.margins;
		int end = c ? record->found.last : record->found.first;
		double *px = c ? look->outer : look->inner;
		lid_chart_px(px, &eye->lids.chart, end, 0.5 * (m->row[0][end] + m->row[1][end]));
		for (int i = 0; i < 3; i++)
			cam[i] = vec_dot(view->cam_from_head[i], eye->canthus[c]) + view->cam_from_head[i][3];
		camera_ray(ray, &view->camera, px);
		for (int i = 0; i < 3; i++)
			at[i] = ray[i] * cam[2] / ray[2] - view->cam_from_head[i][3];
		for (int i = 0; i < 3; i++)
			eye->canthus[c][i] = view->cam_from_head[0][i] * at[0] + view->cam_from_head[1][i] * at[1]
			                     + view->cam_from_head[2][i] * at[2];
	}
	eye->corners_guessed = false;
	lid_track_start(&eye->lids, eye->conf->lid_columns, eye->conf->lid_points, eye->conf->lid_wet, eye->scene->fps);
	return lid_track_push(&record->found, &eye->lids, picture, look);
}

/* How much of an eye the evidence shows, in squares of the limbus' radius. */
static double area_told(const struct evidence *e, double limbus_px)
{
	double sum = 0;
	for (long i = 0; i < (long)e->width * e->height; i++)
		sum += (double)evidence_eye(e, i);
	return sum * pow(e->scale / limbus_px, 2);
}

/* Lids that are taken for shut while the evidence shows an open eye have been learnt wrongly: after a while they are learnt anew. */
static bool learn_again(struct lid_found *found, struct eye_side *eye, const struct lid_picture *picture, const struct lid_look *look, double limbus_px)
{
	const bool denied = !found->open && look->evidence && area_told(look->evidence, limbus_px) > OPEN;
	eye->denied_s = denied ? eye->denied_s + 1 / eye->scene->fps : 0;
	if (eye->denied_s < DENIED_S || !(look->iris_px > 0))
		return true;
	eye->denied_s = 0;
	lid_track_start(&eye->lids, eye->conf->lid_columns, eye->conf->lid_points, eye->conf->lid_wet, eye->scene->fps);
	return lid_track_push(found, &eye->lids, picture, look);
}

/* Finds the lids, then measures gaze between them. */
static void look(struct eye_state *state, struct eye_record *record, struct lid_fine *fine, struct eye_side *eye, const struct eye_frame *frame,
                 const struct gaze_view *view)
{
	const struct eye_scene *scene = eye->scene;
	struct luma luma = { frame->luma, scene->width, scene->height, frame->luma_stride };
	struct lid_picture picture = { frame->rgb, frame->rgb_stride, scene->width, scene->height };
	const struct evidence *evidence = frame->evidence[eye->side];
	struct lid_look look = { .mm = eye_scale(&eye->globe, view), .evidence = evidence };
	double limbus_px = look.mm * eye->globe.limbus, score = eye_seek(eye, &luma, view, evidence, false), plane = gaze_plane(&eye->globe);
	double head_down[3] = { eye->globe.center[0], eye->globe.center[1] - 1, eye->globe.center[2] }, top[2], low[2];
	if (!to_pixel(look.inner, view, eye->canthus[0]) || !to_pixel(look.outer, view, eye->canthus[1])
	    || !to_pixel(top, view, eye->globe.center) || !to_pixel(low, view, head_down)
	    || !gaze_pixel(look.iris, &eye->globe, view, (double[3]){ eye->fick[0], eye->fick[1], 0 }, (double[3]){ 0, 0, plane }))
		return;
	look.down[0] = low[0] - top[0];
	look.down[1] = low[1] - top[1];
	look.iris_px = score > EYE_FOUND ? limbus_px : NAN;
	record->mm = (float)look.mm;
	record->measured = lid_track_push(&record->found, &eye->lids, &picture, &look);
	if (eye->corners_guessed && record->measured)
		record->measured = find_corners(eye, record, &picture, &look, view);
	if (record->measured)
		record->measured = learn_again(&record->found, eye, &picture, &look, limbus_px);
	if (!record->measured)
		return;
	record->open = record->found.open;
	if (!record->found.open)
		return;
	eye_fill_lids(state, &record->found, eye->lids.points);
	lid_fine_look(fine, LID_UPPER, eye->lids.points, record->found.p[LID_UPPER], look.mm, &picture);
	eye_measure(state, record, eye, &luma, view, evidence);
}

static void append(struct eye_side *eye, const struct eye_state *state, const struct eye_record *record, const struct lid_fine *fine)
{
	eye_side_room(eye, eye->frames + 1, 0);
	eye->state[eye->frames] = *state;
	lid_track_keep(&eye->kept[eye->frames], &eye->lids);
	eye->fine[eye->frames] = *fine;
	eye->record[eye->frames++] = *record;
}

/* The eyeball's centre is in the picture. */
static bool in_picture(double center[2], double *mm, const struct eye_side *eye, const struct gaze_view *view)
{
	*mm = eye_scale(&eye->globe, view);
	return to_pixel(center, view, eye->globe.center) && *mm > 0 && center[0] > 0 && center[1] > 0 && center[0] < eye->scene->width
	       && center[1] < eye->scene->height;
}

void eye_side_learn(struct eye_side *eye, const struct eye_frame *frame)
{
	struct eye_state state = blank(frame->time);
	struct eye_record record = { 0 };
	struct lid_fine fine;
	struct gaze_view view;
	double center[2], mm;
	memcpy(record.cam_from_head, frame->cam_from_head, sizeof record.cam_from_head);
	eye_view(&view, eye->scene, record.cam_from_head);
	if (eye->absent || !in_picture(center, &mm, eye, &view))
		return;
	look(&state, &record, &fine, eye, frame, &view);
	eye->have = state.confidence > 0;
	eye->edges = 0;
}

void eye_side_push(struct eye_side *eye, const struct eye_frame *frame)
{
	struct eye_state state = blank(frame->time);
	struct eye_record record = { 0 };
	struct lid_fine fine = { .known = false };
	struct gaze_view view;
	double center[2], mm;
	memcpy(record.cam_from_head, frame->cam_from_head, sizeof record.cam_from_head);
	eye_view(&view, eye->scene, record.cam_from_head);
	if (!eye->absent && in_picture(center, &mm, eye, &view)) {
		struct luma luma = { frame->luma, eye->scene->width, eye->scene->height, frame->luma_stride };
		bool still = change(eye, &luma, center, eye->globe.radius * mm) < eye->conf->still && eye->started;
		eye->started = true;
		if (still) {
			state = eye->state[eye->frames - 1];
			record = eye->record[eye->frames - 1];
			fine = eye->fine[eye->frames - 1];
			state.time = frame->time;
			record.still = true;
		} else {
			look(&state, &record, &fine, eye, frame, &view);
			eye->have = state.confidence > 0 || (eye->have && eye->lost_s < LOST_S);
			eye->lost_s = state.confidence > 0 ? 0 : eye->lost_s + 1 / eye->scene->fps;
		}
	}
	append(eye, &state, &record, &fine);
	eye->last = state;
}
