#include "stages/track/refuse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_draw.h"
#include "image/picture.h"
#include "track/head/pose.h"

static const uint8_t orange[3] = { 255, 150, 30 }, blue[3] = { 90, 170, 255 }, green[3] = { 90, 230, 90 };

static void outline(const struct cv_picture *pic, const struct track_clip *clip, int n, const double (*head)[3], const uint8_t colour[3])
{
	float xy[OPENING_POINTS][2];
	for (int i = 0; i < n; i++) {
		double px[2];
		if (!head_project(px, &clip->camera, clip->cam_from_head, head[i]))
			return;
		xy[i][0] = (float)px[0];
		xy[i][1] = (float)px[1];
	}
	cv_draw_line(pic, n, (const float(*)[2])xy, true, 2, colour);
}

/* The eyeball's outline: a circle across the line of sight, about. */
static void ball(const struct cv_picture *pic, const struct track_clip *clip, const double center[3], double radius)
{
	double ring[OPENING_POINTS][3];
	for (int i = 0; i < OPENING_POINTS; i++) {
		double a = 2 * M_PI * i / OPENING_POINTS;
		ring[i][0] = center[0] + radius * cos(a);
		ring[i][1] = center[1] + radius * sin(a);
		ring[i][2] = center[2];
	}
	outline(pic, clip, OPENING_POINTS, (const double(*)[3])ring, blue);
}

static void margins(const struct cv_picture *pic, const struct eye_state *s)
{
	for (int lid = 0; lid < LIDS; lid++) {
		float xy[LID_POINTS_MAX][2];
		int n = 0;
		for (int i = 0; i < s->lid_points; i++)
			if (isfinite(s->lid[lid][i][0])) {
				xy[n][0] = (float)s->lid[lid][i][0];
				xy[n++][1] = (float)s->lid[lid][i][1];
			}
		if (n > 1)
			cv_draw_line(pic, n, (const float(*)[2])xy, false, 2, green);
	}
}

void refuse_picture(struct stage *stage, const struct track_clip *clip, const struct track_subject *s, const struct track_result *r)
{
	int w = clip->info.width, h = clip->info.height;
	uint8_t *px = mem_array(3 * (size_t)w * (size_t)h + 1, 1);
	struct cv_picture pic = { px, w, h, 3 };
	struct err none = { 0 };
	memcpy(px, clip->rgb, 3 * (size_t)w * (size_t)h);
	for (int e = 0; e < SIDES; e++) {
		if (isfinite(s->center[e][0]))
			ball(&pic, clip, s->center[e], s->radius);
		if (s->opening[e].open)
			outline(&pic, clip, OPENING_POINTS, s->opening[e].edge, orange);
		for (long f = 0; r && f < r->n; f++)
			if (f == clip->reference)
				margins(&pic, &r->eyes.state[f][e]);
	}
	if (file_mkdirs(stage_path(stage, "work/skin"), &none) && picture_png_write(stage_path(stage, REFUSED_PICTURE), px, w, h, 3, &none))
		if (stage_made(stage, REFUSED_PICTURE, 0, 0, &none))
			stage_note(stage, "%s: frame %ld, the openings (orange) and eyeballs (blue) as they were laid on it", REFUSED_PICTURE, clip->reference);
	free(px);
}
