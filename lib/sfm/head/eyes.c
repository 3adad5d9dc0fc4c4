#include "sfm/head/eyes.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "sfm/head/faces.h"

enum { LEAST_VIEWS = 3 };

/* Inlier limit: error of a detected eye as a share of the eyes' distance. A tenth is usual where gaze or head are turned. */
static const double near = 0.2;

static void name(struct opt_each_list *list, const struct view *view, const double value[4])
{
	struct opt_each *to = &list->items[list->n++];
	*to = (struct opt_each){ .name = view_name(view) };
	memcpy(to->value, value, 4 * sizeof *value);
}

/* Adds the eyes of one view: as detected, with the radius that an iris of mean size has there. */
static void take(struct eyes *eyes, const struct sfm_face *f, const struct sfm_eyes *at, const struct head *head, const struct view *v,
                 const struct calibrate_options *o)
{
	const double s = (double)v->width / v->picture_width;
	for (int e = 0; e < 2; e++) {
		double px[2], focal = 0;
		sfm_project(px, &focal, head->model, f->image, at->eye[e]);
		name(&eyes->side[e], v, (double[]){ f->eye[e][0] * s, f->eye[e][1] * s, o->limbus_radius_mm / o->eyes_apart_mm * eyes->apart * focal * s, 0 });
	}
	double mouth[2], focal;
	if (sfm_project(mouth, &focal, head->model, f->image, at->mouth))
		name(&eyes->mouth, v, (double[]){ mouth[0] * s, mouth[1] * s, mouth[0] * s, mouth[1] * s });
}

static void take_all(struct eyes *eyes, const struct faces *faces, const bool *agrees, const struct sfm_eyes *at, const struct head *head,
                     const struct views *views, const struct calibrate_options *o)
{
	double across[3];
	vec_add(across, at->eye[0], -1, at->eye[1]);
	eyes->apart = vec_norm(across);
	eyes->sigma = at->sigma;
	eyes->mouth_found = at->mouths > 0;
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
	struct faces faces;
	struct sfm_eyes at = { .n = 0 };
	*eyes = (struct eyes){ .apart = 0 };
	bool ok = faces_find(&faces, head->model, LEAST_VIEWS, stage, o, err);
	bool *agrees = mem_new((size_t)faces.n + 1, sizeof *agrees);
	if (ok && sfm_eyes(&at, agrees, head->model, faces.n, faces.f, LEAST_VIEWS, near)) {
		take_all(eyes, &faces, agrees, &at, head, views, o);
		stage_figure(stage, "eyes_found", at.n, "views");
		stage_figure(stage, "mouth_found", at.mouths, "views");
	} else if (ok && faces.f)
		stage_skipped(stage, "eyes in the views: no face that %d views agree on is seen from the front. Photograph it from there, too, or "
		              "name the eyes in two views (view.NAME.left_eye_px)", LEAST_VIEWS);
	free(agrees);
	faces_free(&faces);
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
