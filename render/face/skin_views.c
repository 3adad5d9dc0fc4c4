#include "render/face/skin_views.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "image/picture.h"
#include "math/vec.h"
#include "render/face/skin_cameras.h"

static const char cameras_json[] = "work/rig.json", mesh_ply[] = "work/subject.ply";
static const double shape_most = 0.01;         // by which a picture's sides may differ in proportion from those that were registered
static const double lids_mm = 1.5;             // lids stand where the film has them, to a millimetre: so far off the opening is skin
static const double within_mm = 0.5;           // and so far within it the eye
static const double over_mm = 0.5;             // margins lie so far before the eyeball
static const double arc_mm[2] = { 13, 5 };     // half an opening whose margins are not known

void skin_views_find(struct skin_target *t, struct stage *stage, struct err *why)
{
	struct face_camera camera[COMPLEXION_VIEWS];
	struct err none = { 0 };
	json_t *laid = json_read(stage_path(stage, "work/targets/%s/registration.json", t->name), 1 << 24, &none);
	const char *subject = json_string_value(json_object_get(laid, "subject"));
	const bool ours = subject && !strcmp(subject, mesh_ply);
	json_decref(laid);
	t->views = 0;
	if (!ours || !file_exists(stage_path(stage, "%s", mesh_ply)) || !file_exists(stage_path(stage, "%s", cameras_json))) {
		err_set(why, "no mesh was made of views/");
		return;
	}
	t->views = skin_cameras(camera, COMPLEXION_VIEWS, stage, why);
	if (!t->views)
		return;
	t->subject = mesh_ply;
	t->in[t->n_in++] = cameras_json;
	if (!t->film)
		t->in[t->n_in++] = mesh_ply;
	for (int i = 0; i < t->views; i++)
		t->in[t->n_in++] = stage_path(stage, "%s", camera[i].file) + strlen(stage->capture) + 1;
	skin_cameras_free(camera, t->views);
}

/* Margins of the lids in the film's reference, on the eyeballs, head: [TRACKED_MARGINS][m][3]. An arc where they are not known. */
static float (*lids_of(const struct tracked *f))[3]
{
	const long m = f->lids.shape[2];
	const float (*px)[2] = (const float(*)[2])f->lids.data + f->reference * TRACKED_MARGINS * m;
	const double (*pose)[4] = tracked_pose(f, f->reference);
	float (*out)[3] = mem_array((size_t)(TRACKED_MARGINS * m) + 1, sizeof *out);
	for (int lid = 0; lid < TRACKED_MARGINS; lid++) {
		const double *center = f->eye[lid / 2], radius = f->radius + over_mm;
		bool known = true;
		for (long i = lid * m; i < (lid + 1) * m; i++) {
			double ray[3], dir[3] = { 0 }, from[3] = { 0 }, to[3];
			const double at[2] = { (double)px[i][0], (double)px[i][1] };
			known = known && isfinite(at[0] + at[1]) && isfinite(pose[0][0] + pose[2][3]);
			if (!known)
				break;
			camera_ray(ray, &f->camera, at);
			for (int k = 0; k < 3; k++)
				for (int c = 0; c < 3; c++) {
					dir[k] += pose[c][k] * ray[c];
					from[k] -= pose[c][k] * pose[c][3];
				}
			vec_add(to, center, -1, from);
			// Where it meets the eyeball; else where it is nearest to it.
			const double along = vec_dot(to, dir), aside = vec_dot(to, to) - along * along, back = radius * radius - aside;
			for (int k = 0; k < 3; k++)
				out[i][k] = (float)(from[k] + (along - sqrt(fmax(back, 0))) * dir[k]);
		}
		for (long i = 0; i < m && !known; i++) {
			const double x = 2.0 * (double)i / (double)(m - 1) - 1, scale = f->radius / 12, up = (lid % 2 ? -1 : 1) * arc_mm[1] * scale * (1 - x * x);
			const double p[3] = { arc_mm[0] * scale * x, up, sqrt(fmax(radius * radius - up * up - pow(arc_mm[0] * scale * x, 2), 0)) };
			for (int k = 0; k < 3; k++)
				out[lid * m + i][k] = (float)(center[k] + p[k]);
		}
	}
	return out;
}

/* Of points of the head: px of a picture that is [1 / by] as large as the camera's, and mm before it; NAN behind it. */
static void project(float (*at)[3], long n, const float (*x)[3], const struct face_camera *c, const double by[2])
{
	for (long i = 0; i < n; i++) {
		double cam[3], px[2];
		for (int k = 0; k < 3; k++)
			cam[k] = c->cam_from_head[k][0] * (double)x[i][0] + c->cam_from_head[k][1] * (double)x[i][1] + c->cam_from_head[k][2] * (double)x[i][2] + c->cam_from_head[k][3];
		const bool there = camera_project(px, &c->camera, cam);
		for (int k = 0; k < 2; k++)
			at[i][k] = there ? (float)(px[k] * by[k]) : NAN;
		at[i][2] = (float)cam[2];
	}
}

static bool add(struct complexion *c, const struct tracked *f, const float (*lids)[3], const struct face_camera *camera, struct skin_job *job, struct err *err)
{
	uint8_t *rgb;
	int width, height;
	if (!picture_read_small(&rgb, &width, &height, stage_path(job->stage, "%s", camera->file), job->conf->film_px, job->render->limit_mpx, err))
		return false;
	const double by[2] = { (double)width / camera->width, (double)height / camera->height };
	const bool same = fabs(by[0] / by[1] - 1) < shape_most || err_set(err, "%s: not the photograph whose camera was found", camera->file);
	const long m = f->lids.shape[2], size = (long)width * height;
	float (*at)[3] = mem_array((size_t)f->mesh.n_vertices + 1, sizeof *at), (*edge)[3] = mem_array((size_t)(TRACKED_MARGINS * m) + 1, sizeof *edge);
	float (*flat)[2] = mem_array((size_t)(TRACKED_MARGINS * m) + 1, sizeof *flat);
	uint8_t *open = mem_array((size_t)size + 1, 1), *eyes = mem_array((size_t)size + 1, 1);
	if (same) {
		project(at, f->mesh.n_vertices, (const float(*)[3])f->mesh.vertices, camera, by);
		project(edge, TRACKED_MARGINS * m, lids, camera, by);
		for (long i = 0; i < TRACKED_MARGINS * m; i++)
			memcpy(flat[i], edge[i], sizeof flat[i]);
		const double focal = camera->camera.focal_px * sqrt(by[0] * by[1]), px_per_mm = focal / fmax((double)edge[0][2], 1);
		tracked_mark_open(open, width, height, (const float(*)[2])flat, m, (double[]){ lids_mm * px_per_mm, lids_mm * px_per_mm });
		tracked_mark_open(eyes, width, height, (const float(*)[2])flat, m, (double[]){ 0, -within_mm * px_per_mm });
		complexion_add(c, &(struct complexion_view){ rgb, width, height, (const float(*)[3])at, focal, open, 0, 0, eyes });
	}
	free(at);
	free(edge);
	free(flat);
	free(open);
	free(eyes);
	free(rgb);
	return same;
}

bool skin_views_add(struct complexion *c, const struct tracked *f, struct skin_job *job, const struct skin_target *t, struct err *err)
{
	struct face_camera camera[COMPLEXION_VIEWS];
	struct err last = { 0 };
	const int n = skin_cameras(camera, COMPLEXION_VIEWS, job->stage, err);
	float (*lids)[3] = lids_of(f);
	int added = 0;
	for (int i = 0; i < n; i++) {
		struct err why = { 0 };
		if (add(c, f, (const float(*)[3])lids, &camera[i], job, &why))
			added++;
		else {
			stage_skipped(job->stage, "skin of %s: %s", t->name, why.msg);
			last = why;
		}
	}
	free(lids);
	skin_cameras_free(camera, n);
	return added > 0 || (n > 0 && err_set(err, "%s", last.msg));
}
