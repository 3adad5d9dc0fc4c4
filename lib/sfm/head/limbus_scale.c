#include "sfm/head/limbus_scale.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "limbus/propose/score.h"
#include "image/photo/photo.h"
#include "math/stats.h"
#include "math/vec.h"

/* 11.7 mm, 0.5 mm s.d. among adults: of half of it, 0.25 mm. */
static const double limbus_sigma_mm = 0.25;

/* Copies a part of a photograph. */
static struct photo crop(const struct photo *p, int x0, int y0, int w, int h)
{
	struct photo out = *p;
	out.width = w;
	out.height = h;
	out.rgb = mem_array((size_t)w * (size_t)h * 3, sizeof *out.rgb);
	for (int y = 0; y < h; y++)
		memcpy(out.rgb + 3L * y * w, p->rgb + 3 * ((long)(y0 + y) * p->width + x0), (size_t)w * 3 * sizeof *out.rgb);
	return out;
}

/* Hill climbing from circles of three sizes on a grid over the eye's opening: of a detected eye only the middle is known, and of the
 * iris only its mean size among people. */
static void seek(struct ellipse *e, const struct grey *grey, double contrast)
{
	static const double size[] = { 0.86, 1, 1.16 };
	struct ellipse start = *e;
	double best = -1;
	for (int k = 0; k < 7 * 5 * COUNT(size); k++) {
		double a = start.a * size[k % COUNT(size)], x = 0.3 * start.a * (k / COUNT(size) % 7 - 3), y = 0.3 * start.a * (k / COUNT(size) / 7 - 2);
		struct ellipse here = { start.cx + x, start.cy + y, a, a, 0 };
		double score = score_climb(grey, &here, 0.15 * a, 0.05 * a, contrast, SCORE_WIDE);
		if (score > best) {
			best = score;
			*e = here;
		}
	}
}

/* Measures the larger semi-axis of the limbus, px, near the hint (x y radius): a circle's larger semi-axis does not shrink when it is
 * tilted. False when the edge does not support an ellipse. */
static bool measure(double *a, const struct photo *photo, const double hint[3], bool found)
{
	// Lids cover part of an iris. Of a detected one, which may be false, the visible rest has to fit better than of a named one.
	const double room = 2.2, contrast = 0.3, least_score = found ? 0.36 : 0.45, least_aspect = found ? 0.75 : 0;
	int x0 = (int)fmax(0, hint[0] - room * hint[2]), y0 = (int)fmax(0, hint[1] - room * hint[2]);
	int x1 = (int)fmin(photo->width, hint[0] + room * hint[2]), y1 = (int)fmin(photo->height, hint[1] + room * hint[2]);
	if (x1 - x0 < 24 || y1 - y0 < 24)
		return false;
	struct photo part = crop(photo, x0, y0, x1 - x0, y1 - y0);
	struct pyramid pyramid = pyramid_make(&part);
	struct ellipse e = { hint[0] - x0, hint[1] - y0, hint[2], hint[2], 0 };
	if (found)
		seek(&e, &pyramid.level[0], contrast);
	double score = score_climb(&pyramid.level[0], &e, 0.15 * hint[2], 0.1, contrast, SCORE_NARROW);
	pyramid_free(&pyramid);
	free(part.rgb);
	*a = fmax(e.a, e.b);
	return score >= least_score && fmin(e.a, e.b) > least_aspect * *a && *a > 0.7 * hint[2] && *a < 1.4 * hint[2];
}

static int find_view(const struct views *views, const struct head *head, int image)
{
	for (int i = 0; i < views->n_used; i++)
		if (head_image(head, &views->v[i]) == &head->model->images[image])
			return i;
	return -1;
}

/* photo: of the view; null for a frame of a video, which is not stored: the hint's circle is used as it is. */
static void add_view(struct places_lengths *out, const struct head *head, const struct view *view, const struct photo *photo,
                     const double *hint, const double eye[3], double limbus_mm, bool by_hand)
{
	const struct colmap_image *im = head_image(head, view);
	double a = hint[2], R[3][3], p[3], scale = (double)view->picture_width / view->width;
	bool found = photo && measure(&a, photo, hint, !by_hand);
	colmap_rotation(R, im->q);
	mat_vec(p, R, eye);
	double depth = p[2] + im->t[2], focal = head->model->cameras[im->camera].params[0] / scale;
	// A circle drawn by hand is exact to a tenth of its size, a fitted edge to half a pixel. A detected eye without a fitted edge is no
	// measurement.
	if (out->n < PLACES_LENGTHS && (found || by_hand))
		out->l[out->n++] = (struct sfm_length){ a * depth / focal, limbus_mm, found ? 0.5 / a : 0.1 };
}

/* Rejects lengths that differ from the median by more than 12 %. */
static void keep_alike(struct places_lengths *l)
{
	const double far = 0.12;
	double *size = mem_array((size_t)l->n + 1, sizeof *size);
	for (int i = 0; i < l->n; i++)
		size[i] = l->l[i].world;
	double middle = stats_median(l->n, size);
	int n = 0;
	for (int i = 0; i < l->n; i++)
		if (fabs(log(l->l[i].world / middle)) < far)
			l->l[n++] = l->l[i];
	l->n = n;
	free(size);
}

/* Adds the lengths of both eyes of a view. Its photograph is read once, and only where an eye is named or found in it. */
static bool add_eyes(struct places_lengths *out, const struct head *head, const struct view *view, const struct places_face *face,
                     const double eye[2][3], const bool has[2], struct stage *stage, const struct calibrate_options *o, struct err *err)
{
	struct photo photo = { 0 };
	bool read = false;
	for (int e = 0; e < 2; e++)
		for (int i = 0; i < face->eye[e]->n && has[e]; i++) {
			if (!view_is_named(view, face->eye[e]->items[i].name))
				continue;
			if (!read && view->frame < 0 && !(read = photo_load(&photo, stage_path(stage, "%s", view->file), o->limit_mpx, err)))
				return false;
			add_view(out, head, view, read ? &photo : 0, face->eye[e]->items[i].value, eye[e], o->limbus_radius_mm, !face->found);
		}
	if (read)
		photo_free(&photo);
	return true;
}

bool places_limbus(struct places_lengths *out, double *common, const struct head *head, const struct views *views,
                   const struct places_face *face, struct stage *stage, const struct calibrate_options *o, struct err *err)
{
	double eye[2][3];
	bool has[2];
	*common = limbus_sigma_mm / o->limbus_radius_mm;
	for (int e = 0; e < 2; e++)
		if (!places_point(eye[e], &has[e], head, views, face->eye[e], 0, err))
			return err_wrap(err, "capture.conf: view.*.%s_eye_px", e ? "right" : "left");
	for (int k = 0; k < head->model->n_images; k++) {
		int v = find_view(views, head, k);
		if (v >= 0 && !add_eyes(out, head, &views->v[v], face, (const double(*)[3])eye, has, stage, o, err))
			return false;
	}
	if (face->found && out->n)
		keep_alike(out);
	return true;
}
