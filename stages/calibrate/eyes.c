#include "stages/calibrate/eyes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_face.h"
#include "image/picture.h"
#include "math/vec.h"
#include "skin/sfm_eyes.h"

enum { MOST_FACES = 4, LEAST_VIEWS = 3 };

/* Share of the eyes' distance by which a cascade misses an eye at most; a tenth is usual where gaze or head are turned. */
static const double near = 0.2;

struct faces {
	struct sfm_face *f;
	int n, images;  // images: in which there is one
};

static bool look(struct faces *faces, struct cv_face_finder *finder, int turn, const struct head *head, struct stage *stage,
                 const struct calibrate_options *o, struct err *err)
{
	const struct colmap_model *m = head->model;
	for (int i = 0; i < m->n_images; i++) {
		struct cv_face found[MOST_FACES];
		uint8_t *px;
		int w, h, n;
		if (!picture_read(&px, &w, &h, stage_path(stage, CALIBRATE_DIR "/pictures/%s", m->images[i].name), o->limit_mpx, err))
			return false;
		for (long k = 0; k < (long)w * h; k++)
			px[k] = px[3 * k + 1];
		bool ok = cv_face_find(&n, found, MOST_FACES, finder, px, w, h, turn, err);
		free(px);
		if (!ok)
			return false;
		for (int k = 0; k < n; k++) {
			struct sfm_face *to = &faces->f[faces->n++];
			*to = (struct sfm_face){ .image = i };
			memcpy(to->eye, found[k].eye, sizeof to->eye);
			memcpy(to->mouth, found[k].mouth, sizeof to->mouth);
		}
		faces->images += n > 0;
	}
	return true;
}

static int by_image(const void *a, const void *b)
{
	const struct sfm_face *p = a, *q = b;
	return p->image != q->image ? p->image - q->image : p->eye[0][0] < q->eye[0][0] ? -1 : p->eye[0][0] > q->eye[0][0];
}

static void name(struct opt_each_list *list, const struct view *view, const double value[4])
{
	struct opt_each *to = &list->items[list->n++];
	*to = (struct opt_each){ .name = view_name(view) };
	memcpy(to->value, value, 4 * sizeof *value);
}

/* The eyes of one view, as seen and with the iris's size to be expected there. */
static void take(struct eyes *eyes, const struct sfm_face *f, const struct sfm_eyes *at, const struct head *head, const struct view *v,
                 const struct calibrate_options *o)
{
	const double s = (double)v->width / v->picture_width;
	for (int e = 0; e < 2; e++) {
		double px[2], focal = 0;
		sfm_project(px, &focal, head->model, f->image, at->eye[e]);
		name(&eyes->side[e], v, (double[]){ f->eye[e][0] * s, f->eye[e][1] * s, o->limbus_radius_mm / o->eyes_apart_mm * eyes->apart * focal * s, 0 });
	}
	name(&eyes->mouth, v, (double[]){ f->mouth[0] * s, f->mouth[1] * s, f->mouth[0] * s, f->mouth[1] * s });
}

static void take_all(struct eyes *eyes, const struct faces *faces, const bool *agrees, const struct sfm_eyes *at, const struct head *head,
                     const struct views *views, const struct calibrate_options *o)
{
	double across[3];
	vec_add(across, at->eye[0], -1, at->eye[1]);
	eyes->apart = vec_norm(across);
	eyes->sigma = at->sigma;
	for (int k = 0; k < 3; k++)
		(k < 2 ? &eyes->side[k] : &eyes->mouth)->items = mem_new((size_t)at->n + 1, sizeof(struct opt_each));
	for (int i = 0; i < faces->n; i++)
		for (int v = 0; v < views->n_used && agrees[i]; v++)
			if (head_image(head, &views->v[v]) == &head->model->images[faces->f[i].image])
				take(eyes, &faces->f[i], at, head, &views->v[v], o);
}

bool eyes_find(struct eyes *eyes, const struct head *head, const struct views *views, struct stage *stage,
               const struct calibrate_options *o, struct err *err)
{
	struct cv_face_finder *finder;
	struct faces faces = { .f = mem_new((size_t)head->model->n_images * MOST_FACES * 4, sizeof *faces.f) };
	struct sfm_eyes at = { .n = 0 };
	*eyes = (struct eyes){ .apart = 0 };
	if (!cv_face_open(&finder, err)) {
		stage_skipped(stage, "eyes in the views: %s", err->msg);
		*err = (struct err){ 0 };
		free(faces.f);
		return true;
	}
	// Cameras are held upright, mostly.
	bool ok = look(&faces, finder, 0, head, stage, o, err);
	for (int turn = 1; turn < 4 && ok && faces.images < LEAST_VIEWS; turn++)
		ok = look(&faces, finder, turn, head, stage, o, err);
	cv_face_close(finder);
	bool *agrees = mem_new((size_t)faces.n + 1, sizeof *agrees);
	qsort(faces.f, (size_t)faces.n, sizeof *faces.f, by_image);
	if (ok && sfm_eyes(&at, agrees, head->model, faces.n, faces.f, LEAST_VIEWS, near)) {
		take_all(eyes, &faces, agrees, &at, head, views, o);
		stage_figure(stage, "eyes_found", at.n, "views");
	} else if (ok)
		stage_skipped(stage, "eyes in the views: no face that %d views agree on is seen from the front. Photograph it from there, too, or "
		              "name the eyes in two views (view.NAME.left_eye_px)", LEAST_VIEWS);
	free(agrees);
	free(faces.f);
	return ok;
}

static void list_free(struct opt_each_list *list)
{
	for (int i = 0; i < list->n; i++)
		free(list->items[i].name);
	free(list->items);
}

void eyes_free(struct eyes *eyes)
{
	list_free(&eyes->side[0]);
	list_free(&eyes->side[1]);
	list_free(&eyes->mouth);
}
