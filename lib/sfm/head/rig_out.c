/* The cameras in the form of work/rig.json: px of the photographs, mm in the head's frame. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "sfm/head/head.h"

const struct colmap_image *head_image(const struct head *head, const struct view *view)
{
	for (int i = 0; i < head->model->n_images; i++)
		if (!strcmp(head->model->images[i].name, view->picture))
			return &head->model->images[i];
	return 0;
}

static bool fill(struct rig_camera *c, const struct head *head, const struct view *view, const struct colmap_image *image,
                 struct err *err)
{
	const struct colmap_model *m = head->model;
	const double sx = (double)view->width / view->picture_width, sy = (double)view->height / view->picture_height;
	*c = (struct rig_camera){ .name = view_name(view), .file = mem_str(view->file), .frame = view->frame, .width = view->width,
		                      .height = view->height, .has_pose = true };
	if (!colmap_to_camera(&c->camera, c->focal, &m->cameras[image->camera], err))
		return false;
	c->focal[0] *= sx;
	c->focal[1] *= sy;
	c->camera.focal_px = sqrt(c->focal[0] * c->focal[1]);
	c->camera.center_px[0] *= sx;
	c->camera.center_px[1] *= sy;
	sfm_cam_from_head(c->cam_from_head, &head->frame, image);
	c->residual_px = colmap_residual(m, (int)(image - m->images)) * sqrt(sx * sy);
	for (int k = 0; k < image->n_seen; k++)
		c->points += image->seen[k].point >= 0;
	return true;
}

static json_t *text(const char *s)
{
	json_t *t = json_string(s);
	return t ? t : json_string("(name is not UTF-8)");
}

static char *extras(const struct head *head, const struct views *views)
{
	json_t *out = json_array();
	for (int i = 0; i < views->n; i++) {
		const struct view *v = &views->v[i];
		const char *reason = *v->reason ? v->reason : head_image(head, v) ? 0 : "shares too little with the others";
		if (reason) {
			json_t *row = json_pack("{s:o,s:o}", "file", text(v->file), "reason", text(reason));
			if (v->frame >= 0)
				json_object_set_new(row, "frame", json_integer(v->frame));
			json_array_append_new(out, row);
		}
	}
	json_t *json = json_pack("{s:o,s:o,s:o,s:i}", "not_registered", out, "mm_per_unit", json_number(head->frame.scale),
	                         "residual_px", json_number(head->residual_px), "points", head->model->n_points);
	char *dump = json_dumps(json, JSON_COMPACT);
	json_decref(json);
	return dump;
}

bool rig_out(struct camera_rig *rig, struct head *head, const struct views *views, const char *path, const char *made_by,
             struct err *err)
{
	double sum = 0;
	long n = 0;
	bool ok = true;
	*rig = (struct camera_rig){ .cameras = mem_new((size_t)views->n_used, sizeof *rig->cameras), .scale_sigma = head->scale_sigma,
		                        .has_eyes = head->has_eyes };
	memcpy(rig->eye_center, head->eye_center, sizeof rig->eye_center);
	snprintf(rig->scale_source, sizeof rig->scale_source, "%s", head->scale_source);
	snprintf(rig->frame_source, sizeof rig->frame_source, "%s", head->frame_source);
	for (int i = 0; i < views->n_used && ok; i++) {
		const struct colmap_image *image = head_image(head, &views->v[i]);
		if (!image)
			continue;
		struct rig_camera *c = &rig->cameras[rig->n++];
		ok = fill(c, head, &views->v[i], image, err);
		sum += c->points ? c->points * c->residual_px : 0;
		n += c->points;
	}
	head->residual_px = n ? sum / (double)n : NAN;
	char *extra = extras(head, views);
	ok = ok && camera_rig_save(rig, path, made_by, extra, err);
	free(extra);
	return ok;
}
