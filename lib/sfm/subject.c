#include "sfm/subject.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/om_mesh.h"
#include "image/picture.h"
#include "sfm/cloud/dense.h"
#include "sfm/cloud/surface.h"
#include "sfm/cloud/surface_colour.h"
#include "sfm/colmap/run.h"
#include "sfm/template.h"

enum { MESH_LIMIT = 20000000 };
#define CLOUD CALIBRATE_DIR "/cloud.ply"
#define RAW_MESH CALIBRATE_DIR "/poisson.ply"

bool subject_given(struct stage *stage)
{
	return file_exists(stage_path(stage, "subject.ply")) || file_exists(stage_path(stage, "subject.obj"));
}

/* COLMAP's Poisson mesher; Debian builds COLMAP without CGAL, so that its other mesher is missing. One thread: on several its sums, and so
 * its triangles, differ from run to run. */
static bool poisson(struct stage *stage, const struct calibrate_options *o, struct err *err)
{
	char *depth = mem_printf("%d", o->mesh_depth), *trim = mem_printf("%g", o->mesh_trim);
	const char *const args[] = { "--input_path", "cloud.ply", "--output_path", "poisson.ply",
		"--PoissonMeshing.depth", depth, "--PoissonMeshing.trim", trim, "--PoissonMeshing.color", "0",
		"--PoissonMeshing.num_threads", "1", 0 };
	bool ok = colmap_run_inside(stage, "poisson_mesher", args, "mesh", err);
	free(depth);
	free(trim);
	return ok;
}

/* Transforms the mesh from world to head and keeps the inside of the subject's ball: where it has no points the mesher closes the
 * surface with balloons. */
static void clean(struct mesh *mesh, const struct head *head)
{
	bool *keep = mem_new((size_t)mesh->n_vertices, sizeof *keep);
	for (int i = 0; i < mesh->n_vertices; i++) {
		double world[3], from = 0, p[3];
		for (int k = 0; k < 3; k++) {
			world[k] = (double)mesh->vertices[i][k];
			from += (world[k] - head->subject.center[k]) * (world[k] - head->subject.center[k]);
		}
		keep[i] = from <= head->subject.radius * head->subject.radius;
		sfm_to_head(p, &head->frame, world);
		for (int k = 0; k < 3; k++)
			mesh->vertices[i][k] = (float)p[k];
	}
	surface_largest(mesh, keep);
	free(keep);
}

static bool view_of(struct surface_view *out, const struct head *head, const struct colmap_image *image, struct err *err)
{
	struct camera camera;
	const struct colmap_camera *c = &head->model->cameras[image->camera];
	if (!colmap_to_camera(&camera, out->focal, c, err))
		return false;
	sfm_cam_from_head(out->cam_from_mesh, &head->frame, image);
	memcpy(out->center_px, camera.center_px, sizeof out->center_px);
	memcpy(out->distortion, camera.distortion, sizeof out->distortion);
	out->width = c->width;
	out->height = c->height;
	return true;
}

static bool colour(struct mesh *mesh, const struct head *head, struct stage *stage, const struct calibrate_options *o,
                   struct err *err)
{
	const struct colmap_model *m = head->model;
	struct surface_view *views = mem_new((size_t)m->n_images, sizeof *views);
	int (*best)[SURFACE_BEST] = mem_array((size_t)mesh->n_vertices, sizeof *best);
	float (*sum)[4] = mem_new((size_t)mesh->n_vertices, sizeof *sum);
	bool ok = true;
	for (int i = 0; i < m->n_images && ok; i++)
		ok = view_of(&views[i], head, &m->images[i], err);
	if (ok)
		surface_best_views(best, mesh, m->n_images, views);
	for (int i = 0; i < m->n_images && ok; i++) {
		uint8_t *px;
		int w, h;
		ok = picture_read(&px, &w, &h, stage_path(stage, CALIBRATE_DIR "/pictures/%s", m->images[i].name), o->limit_mpx, err);
		if (ok) {
			surface_add_colour(sum, mesh, i, &views[i], px, w, h, (const int (*)[SURFACE_BEST])best);
			free(px);
		}
	}
	if (ok)
		surface_set_colours(mesh, (const float (*)[4])sum);
	free(views);
	free(best);
	free(sum);
	return ok;
}

bool subject_make(const struct head *head, const struct views *views, struct stage *stage, const struct calibrate_options *o,
                  const char *made_by, struct err *err)
{
	struct cloud_points cloud = { 0 };
	struct mesh mesh = { 0 };
	struct err none = { 0 };
	bool ok = dense_cloud(&cloud, head, views, stage, o, err);
	if (ok && cloud.n < o->mesh_min_points) {
		stage_skipped(stage, "subject mesh: only %ld points of the surface found: take more photographs, closer together", cloud.n);
		cloud_points_free(&cloud);
		return file_remove(stage_path(stage, SUBJECT), err);
	}
	ok = ok && cloud_save(&cloud, stage_path(stage, CLOUD), err) && poisson(stage, o, err)
	     && om_mesh_load(&mesh, stage_path(stage, RAW_MESH), MESH_LIMIT, err);
	if (ok)
		clean(&mesh, head);
	bool laid = false;
	ok = ok && (!o->template || template_lay(&laid, &mesh, &cloud, head, stage, o, err));
	ok = ok && (laid || mesh.n_faces <= o->mesh_faces || om_mesh_decimate(&mesh, o->mesh_faces, err))
	     && colour(&mesh, head, stage, o, err) && om_mesh_save(&mesh, stage_path(stage, SUBJECT), made_by, err);
	if (ok) {
		stage_note(stage, "subject: %d vertices, %d faces from %ld points", mesh.n_vertices, mesh.n_faces, cloud.n);
		stage_figure(stage, "cloud", (double)cloud.n, "points");
		stage_figure(stage, "subject_vertices", mesh.n_vertices, "");
	}
	file_remove(stage_path(stage, RAW_MESH), &none);
	cloud_points_free(&cloud);
	mesh_free(&mesh);
	return ok;
}
