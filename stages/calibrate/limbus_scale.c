/* The scale from the eye itself: the visible iris has much the same width in all adults. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "eye/limbus_score.h"
#include "image/photo.h"
#include "math/vec.h"
#include "stages/calibrate/places.h"

/* 11.7 mm, 0.5 mm s.d. among adults: of half of it, 0.25 mm. */
static const double limbus_sigma_mm = 0.25;

/* Part of a photograph, as a photograph of its own. */
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

/* The ellipse's larger semi-axis from where a hand has put it, px: the width of a circle does not shrink with its turn.
 * False when no edge supports it. */
static bool measure(double *a, const struct photo *photo, const double hint[3])
{
	const double room = 2.2, contrast = 0.3, least_score = 0.45;
	int x0 = (int)fmax(0, hint[0] - room * hint[2]), y0 = (int)fmax(0, hint[1] - room * hint[2]);
	int x1 = (int)fmin(photo->width, hint[0] + room * hint[2]), y1 = (int)fmin(photo->height, hint[1] + room * hint[2]);
	if (x1 - x0 < 24 || y1 - y0 < 24)
		return false;
	struct photo part = crop(photo, x0, y0, x1 - x0, y1 - y0);
	struct pyramid pyramid = pyramid_make(&part);
	struct ellipse e = { hint[0] - x0, hint[1] - y0, hint[2], hint[2], 0 };
	double score = score_climb(&pyramid.level[0], &e, 0.15 * hint[2], 0.1, contrast, SCORE_NARROW);
	pyramid_free(&pyramid);
	free(part.rgb);
	*a = fmax(e.a, e.b);
	return score >= least_score && *a > 0.7 * hint[2] && *a < 1.4 * hint[2];
}

static int find_view(const struct views *views, const struct head *head, int image)
{
	for (int i = 0; i < views->n_used; i++)
		if (head_image(head, &views->v[i]) == &head->model->images[image])
			return i;
	return -1;
}

static bool add_view(struct places_lengths *out, const struct head *head, const struct view *view, const double *hint,
                     const double eye[3], struct stage *stage, const struct calibrate_options *o, struct err *err)
{
	struct photo photo;
	const struct colmap_image *im = head_image(head, view);
	double a = hint[2], R[3][3], p[3], scale = (double)view->picture_width / view->width;
	bool found = false;
	// Of a video's frame no photograph is kept: the hand's circle has to do.
	if (view->frame < 0) {
		if (!photo_load(&photo, stage_path(stage, "%s", view->file), o->limit_mpx, err))
			return false;
		found = measure(&a, &photo, hint);
		photo_free(&photo);
	}
	colmap_rotation(R, im->q);
	mat_vec(p, R, eye);
	double depth = p[2] + im->t[2], focal = head->model->cameras[im->camera].params[0] / scale;
	// A hand draws the circle to a tenth of its size; the edge is found to half a pixel.
	if (out->n < PLACES_LENGTHS)
		out->l[out->n++] = (struct sfm_length){ a * depth / focal, o->limbus_radius_mm, found ? 0.5 / a : 0.1 };
	return true;
}

bool places_limbus(struct places_lengths *out, double *common, const struct head *head, const struct views *views,
                   struct stage *stage, const struct calibrate_options *o, struct err *err)
{
	const struct opt_each_list *eyes[] = { &o->left_eye, &o->right_eye };
	*common = limbus_sigma_mm / o->limbus_radius_mm;
	for (int e = 0; e < 2; e++) {
		double eye[3];
		bool found;
		if (!places_point(eye, &found, head, views, eyes[e], 0, err))
			return err_wrap(err, "capture.conf: view.*.%s_eye_px", e ? "right" : "left");
		for (int i = 0; i < eyes[e]->n && found; i++)
			for (int k = 0; k < head->model->n_images; k++) {
				int v = find_view(views, head, k);
				if (v >= 0 && view_is_named(&views->v[v], eyes[e]->items[i].name)
				    && !add_view(out, head, &views->v[v], eyes[e]->items[i].value, eye, stage, o, err))
					return false;
			}
	}
	return true;
}
