#include "sfm/template.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "bridge/om_mesh.h"
#include "math/stats.h"
#include "mesh/closest.h"
#include "register/transfer_unit.h"

enum { POINTS = 20000, TEMPLATE_VERTICES = 2000000 };

/* Median distance of the cloud's points from a mesh, mm; distances above `reach` count as `reach`. */
static double residual(const struct mesh *mesh, const struct cloud_points *cloud, const struct sfm_frame *frame, double reach)
{
	struct closest_scene *scene = closest_new(mesh, 0);
	long n = cloud->n < POINTS ? cloud->n : POINTS;
	double *d = mem_array((size_t)n + 1, sizeof *d);
#pragma omp parallel for
	for (long i = 0; i < n; i++) {
		const float *p = cloud->xyz[i * cloud->n / n];
		double world[3] = { (double)p[0], (double)p[1], (double)p[2] }, h[3];
		sfm_to_head(h, frame, world);
		struct closest_point c = closest_find(scene, (float[3]){ (float)h[0], (float)h[1], (float)h[2] }, 0, 0, (float)reach, -1);
		d[i] = c.face < 0 ? reach : (double)c.distance;
	}
	double middle = stats_median((int)n, d);
	free(d);
	closest_free(scene);
	return middle;
}

static bool load(struct mesh *mesh, struct stage *stage, const char *file, struct err *err)
{
	char *path;
	if (!file_inside(&path, stage->capture, file, err))
		return err_wrap(err, "capture.conf: calibrate.template");
	bool ok = om_mesh_load(mesh, path, TEMPLATE_VERTICES, err)
	          && (mesh->n_faces > 0 || err_set(err, "%s: has no faces: a template is a mesh", file));
	free(path);
	double unit = ok ? transfer_subject_unit(mesh) : 1;
	for (int i = 0; i < mesh->n_vertices && ok; i++)
		for (int k = 0; k < 3; k++)
			mesh->vertices[i][k] *= (float)unit;
	return ok;
}

bool template_lay(bool *laid, struct mesh *surface, const struct cloud_points *cloud, const struct head *head,
                  struct stage *stage, const struct calibrate_options *o, struct err *err)
{
	const double reach = 30;
	struct mesh mesh = { 0 };
	struct transfer t = { 0 };
	struct err why = { 0 };
	*laid = false;
	if (!load(&mesh, stage, o->template, err)) {
		mesh_free(&mesh);
		return false;
	}
	if (!transfer_run(&t, &mesh, surface, 0, &o->transfer, &why))
		stage_skipped(stage, "%s: cannot be laid onto the surface (%s): the surface is the subject's mesh", o->template, why.msg);
	else {
		double cell = o->cloud.voxel * head->subject.radius * head->frame.scale, was = residual(surface, cloud, &head->frame, reach);
		float (*own)[3] = mesh.vertices;
		mesh.vertices = t.registered;
		double is = residual(&mesh, cloud, &head->frame, reach);
		*laid = is <= was + o->template_cells * cell;
		stage_note(stage, "the middle point lies %.2f mm from the template, %.2f mm from the surface: the %s is the subject's mesh", is, was,
		           *laid ? "template" : "surface");
		stage_figure(stage, "template_residual", is, "mm");
		stage_figure(stage, "surface_residual", was, "mm");
		t.registered = *laid ? own : t.registered;
		mesh.vertices = *laid ? mesh.vertices : own;
	}
	if (*laid) {
		struct mesh surface_was = *surface;
		*surface = mesh;
		mesh = surface_was;
		free(surface->colours);  // its own have nothing to do with the person's
		surface->colours = 0;
	}
	transfer_free(&t);
	mesh_free(&mesh);
	return true;
}
