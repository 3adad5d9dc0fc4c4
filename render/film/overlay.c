/* The person's video with what was tracked drawn on it: margins of the lids, points of skin, the gaze of each eye as a needle, and where the face points. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/mem.h"
#include "base/npy/npy.h"
#include "bridge/cv_draw.h"
#include "bridge/cv_photo.h"
#include "render/film/film.h"

enum { SIDES = 2, LIDS = 4, MOST_POINTS = 300, LEGEND = 28 };

static const uint8_t upper[3] = { 90, 230, 90 }, lower[3] = { 90, 170, 255 }, needle[3] = { 255, 150, 30 }, skin_colour[3] = { 250, 230, 120 }, paper[3] = { 235, 235, 235 };
static const double face_reach = 0.25;  // of a needle's length

struct overlay {
	struct csv_table gaze;
	struct npy lids, skin, confidence;
	int g[SIDES][2], sure[SIDES], time, head[3];  // columns
	double scale;                        // px of the picture in one of the video
	struct cv_picture pic;
};

static bool load(struct overlay *o, struct skin_job *job, const char *const in[], struct err *err)
{
	static const char *const names[SIDES][3] = { { "g1_deg", "g2_deg", "confidence_left" }, { "g6_deg", "g7_deg", "confidence_right" } };
	const char *lids = stage_path(job->stage, "%s", in[2]), *skin = stage_path(job->stage, "%s", in[3]), *sure = stage_path(job->stage, "%s", in[4]);
	if (!csv_read(&o->gaze, stage_path(job->stage, "%s", in[0]), err) || !npy_read(&o->lids, lids, NPY_LIMIT, err)
	    || !npy_read(&o->skin, skin, NPY_LIMIT, err) || !npy_read(&o->confidence, sure, NPY_LIMIT, err))
		return false;
	const long n = o->gaze.n_rows;
	if (!npy_expect(&o->lids, lids, 4, (long[]){ n, LIDS, -1, 2 }, err) || !npy_expect(&o->skin, skin, 3, (long[]){ n, -1, 2 }, err)
	    || !npy_expect(&o->confidence, sure, 2, (long[]){ n, o->skin.shape[1] }, err))
		return false;
	if (o->lids.type != NPY_F4 || o->skin.type != NPY_F4 || o->confidence.type != NPY_F4)
		return err_set(err, "%s: must be float32, as track writes it", lids);
	for (int e = 0; e < SIDES; e++) {
		for (int k = 0; k < 2; k++)
			o->g[e][k] = csv_column(&o->gaze, names[e][k]);
		o->sure[e] = csv_column(&o->gaze, names[e][2]);
	}
	o->time = csv_column(&o->gaze, "time_s");
	static const char *const head[3] = { "head_h_deg", "head_v_deg", "head_t_deg" };
	for (int k = 0; k < 3; k++)
		o->head[k] = csv_column(&o->gaze, head[k]);
	return true;
}

/* A margin, and the middle of all its points that are known. */
static void draw_lid(struct overlay *o, long f, int lid, double middle[2], int *known)
{
	const long m = o->lids.shape[2];
	const float (*p)[2] = (const float(*)[2])o->lids.data + (f * LIDS + lid) * m;
	float xy[64][2];
	int n = 0;
	for (long i = 0; i < m && n < 64; i++)
		if (isfinite(p[i][0])) {
			for (int k = 0; k < 2; k++) {
				xy[n][k] = (float)(o->scale * (double)p[i][k]);
				middle[k] += (double)xy[n][k];
			}
			n++;
			++*known;
		}
	if (n > 1)
		cv_draw_line(&o->pic, n, (const float(*)[2])xy, false, 1, lid % 2 ? lower : upper);
}

/* Angle of a column, radians; 0 where it is not known. */
static double angle(const struct overlay *o, long f, int column)
{
	const double x = csv_at(&o->gaze, f, column) * M_PI / 180;
	return isfinite(x) ? x : 0;
}

/* A needle that leaves the face at h, v (Fick angles against the head, radians) as the picture has it: half the picture's height long at a right angle. */
static void draw_needle(struct overlay *o, long f, const double from[2], double h, double v, double share, int thick, const uint8_t colour[3])
{
	const double hh = angle(o, f, o->head[0]), hv = angle(o, f, o->head[1]), ht = angle(o, f, o->head[2]), reach = share * 0.5 * o->pic.height;
	// Ry(hh) Rx(-hv) Rz(ht), x aside, y up, z to the camera
	const double d[3] = { sin(h) * cos(v), sin(v), cos(h) * cos(v) }, x = cos(ht) * d[0] - sin(ht) * d[1], a = sin(ht) * d[0] + cos(ht) * d[1];
	const double y = cos(hv) * a + sin(hv) * d[2], z = cos(hv) * d[2] - sin(hv) * a;
	const float xy[2][2] = { { (float)from[0], (float)from[1] }, { (float)(from[0] + reach * (cos(hh) * x + sin(hh) * z)), (float)(from[1] - reach * y) } };
	cv_draw_line(&o->pic, 2, xy, false, thick, colour);
}

static void draw_skin(struct overlay *o, long f)
{
	const long m = o->skin.shape[1], step = m > MOST_POINTS ? m / MOST_POINTS : 1;
	const float (*p)[2] = (const float(*)[2])o->skin.data + f * m, *sure = (const float *)o->confidence.data + f * m;
	for (long i = 0; i < m; i += step) {
		const float x = (float)o->scale * p[i][0], y = (float)o->scale * p[i][1];
		const float xy[2][2] = { { x - 0.5f, y }, { x + 0.5f, y } };
		if (sure[i] > 0.3f)
			cv_draw_line(&o->pic, 2, xy, false, 1, skin_colour);
	}
}

static void draw(struct overlay *o, long f)
{
	char text[120];
	double between[2] = { 0 };
	int at = 8, both = 0;
	draw_skin(o, f);
	at += cv_draw_text(&o->pic, at, o->pic.height - 9, 11, (snprintf(text, sizeof text, "%6.2f s", csv_at(&o->gaze, f, o->time)), text), paper) + 24;
	for (int e = SIDES - 1; e >= 0; e--) {
		double middle[2] = { 0 };
		int known = 0;
		for (int lid = 0; lid < 2; lid++)
			draw_lid(o, f, 2 * e + lid, middle, &known);
		const double h = csv_at(&o->gaze, f, o->g[e][0]), v = csv_at(&o->gaze, f, o->g[e][1]);
		for (int k = 0; k < 2 && known; k++)
			between[k] += 0.5 * middle[k] / known;
		both += known > 0;
		if (known && isfinite(h + v))
			draw_needle(o, f, (const double[2]){ middle[0] / known, middle[1] / known }, h * M_PI / 180, v * M_PI / 180, 1, 2, needle);
		if (isfinite(h + v))
			snprintf(text, sizeof text, "%s %+5.1f %+5.1f (%.0f %%)", e ? "right" : "left", h, v, 100 * csv_at(&o->gaze, f, o->sure[e]));
		else
			snprintf(text, sizeof text, "%s: not known", e ? "right" : "left");
		at += cv_draw_text(&o->pic, at, o->pic.height - 9, 11, text, paper) + 24;
	}
	if (both == SIDES)
		draw_needle(o, f, between, 0, 0, face_reach, 1, paper);
}

static bool frames(struct overlay *o, struct skin_job *job, struct video *video, const struct video_info *info, struct video_writer *writer, struct err *err)
{
	const int step = (int)fmax(1, ceil(info->fps / job->conf->clip_fps - 0.01)), high = o->pic.height - LEGEND;
	uint8_t *whole = mem_array(3 * (size_t)info->width * (size_t)info->height + 1, 1);
	bool ok = true, got = true;
	while (ok && got) {
		struct video_frame f;
		ok = video_next(&f, &got, video, err);
		got = got && f.index < o->gaze.n_rows && f.time <= job->conf->clip_seconds;
		if (ok && got && f.index % step == 0) {
			video_frame_rgb(whole, 3 * f.width, &f, 0, 0, f.width, f.height);
			uint8_t *small = cv_resize8(whole, f.width, f.height, 3, o->pic.width, high);
			memcpy(o->pic.px, small, 3 * (size_t)o->pic.width * (size_t)high);
			memset(o->pic.px + 3 * (size_t)o->pic.width * (size_t)high, 24, 3 * (size_t)o->pic.width * LEGEND);
			free(small);
			draw(o, f.index);
			ok = video_writer_put(writer, o->pic.px, f.time, err);
			stage_progress(job->stage, (int)f.index + 1, (int)o->gaze.n_rows, "film");
		}
		video_frame_free(&f);
	}
	free(whole);
	return ok;
}

bool film_overlay(struct skin_job *job, const char *rel, int n, const char *const in[], struct err *err)
{
	struct overlay o = { 0 };
	struct video_info info;
	struct video *video = 0;
	bool ok = load(&o, job, in, err) && (video = video_open(&info, stage_path(job->stage, "%s", in[n - 1]), &job->conf->video, err));
	if (ok) {
		const int width = info.width < 2 * job->conf->clip_px ? info.width : 2 * job->conf->clip_px;
		o.scale = (double)width / info.width;
		o.pic = (struct cv_picture){ .width = width, .height = (int)lround(o.scale * info.height) + LEGEND, .channels = 3 };
		o.pic.px = mem_array(3 * (size_t)o.pic.width * (size_t)o.pic.height + 1, 1);
		struct video_writer_conf w = { .width = o.pic.width, .height = o.pic.height, .fps = fmin(info.fps, job->conf->clip_fps), .crf = job->conf->clip_crf,
			                           .preset = "veryfast", .made_by = stage_made_by(job->stage, n, in) };
		struct video_writer *writer = video_writer_open(stage_path(job->stage, "%s", rel), &w, err);
		ok = writer && frames(&o, job, video, &info, writer, err);
		ok = video_writer_close(writer, ok, err) && ok;
		free(o.pic.px);
	}
	video_close(video);
	csv_table_free(&o.gaze);
	npy_free(&o.lids);
	npy_free(&o.skin);
	npy_free(&o.confidence);
	return ok;
}
