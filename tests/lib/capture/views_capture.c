#include "tests/lib/capture/views_capture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "bridge/om_mesh.h"
#include "math/stats.h"

enum { MESH_LIMIT = 20000000, PHOTO_LIMIT = 1 << 28 };

static bool copy(const char *from, const char *to, const char *name, struct err *err)
{
	char *data, *source = mem_printf("%s/%s", from, name), *target = mem_printf("%s/%s", to, name);
	size_t size;
	bool ok = file_read(&data, &size, source, PHOTO_LIMIT, err);
	if (ok) {
		ok = file_write(target, data, size, err);
		free(data);
	}
	free(source);
	free(target);
	return ok;
}

bool views_capture(const char *dir, const char *images, const char *const names[], const char *leave_out, const char *conf,
                   struct err *err)
{
	struct file_list list;
	char *views = mem_printf("%s/views", dir), *path = mem_printf("%s/capture.conf", dir);
	bool ok = file_mkdirs(views, err) && file_write(path, conf, strlen(conf), err) && file_list(&list, images, err);
	if (ok) {
		for (int i = 0; i < list.n && ok && !names; i++)
			ok = (leave_out && !strcmp(list.names[i], leave_out)) || copy(images, views, list.names[i], err);
		for (int i = 0; names && names[i] && ok; i++)
			ok = copy(images, views, names[i], err);
		file_list_free(&list);
	}
	free(views);
	free(path);
	return ok;
}

bool views_calibrate(struct spent *spent, const char *dir, struct err *err)
{
	char *capture = mem_printf("--capture=%s", dir), *log = mem_printf("%s.log", dir);
	bool ok = spent_run(spent, (const char *const[]){ "bin/calibrate", capture, 0 }, log, err);
	free(capture);
	free(log);
	return ok;
}

double views_residual(const struct camera_rig *rig)
{
	double sum = 0, n = 0;
	for (int i = 0; i < rig->n; i++) {
		sum += rig->cameras[i].residual_px * rig->cameras[i].points;
		n += rig->cameras[i].points;
	}
	return sum / n;
}

bool views_mesh_within(double *share, double *middle, const char *path, const struct views_fit *fit,
                       const struct sweep_points *surface, struct err *err)
{
	struct mesh mesh;
	if (!om_mesh_load(&mesh, path, MESH_LIMIT, err))
		return false;
	// The head is 1.25 radii of its ball tall, as the ball was chosen; 1 % of that.
	double size = 2 * surface->radius / 1.25, reach = 0.03 * size;
	struct sweep_index *index = sweep_index_new(surface, reach);
	double *d = mem_array((size_t)mesh.n_vertices + 1, sizeof *d);
	int n = 0, near = 0;
	for (int i = 0; i < mesh.n_vertices; i++) {
		double p[3], head[3] = { (double)mesh.vertices[i][0], (double)mesh.vertices[i][1], (double)mesh.vertices[i][2] };
		views_to_truth(p, fit, head);
		double off = sweep_distance(index, p);
		if (!isfinite(off))
			continue;
		near += off <= 0.01 * size;
		d[n++] = off / size;
	}
	printf("mesh: %d vertices, %d beside the measured surface\n", mesh.n_vertices, n);
	*share = (double)near / n;
	*middle = stats_quantile(n, d, 0.5);
	free(d);
	sweep_index_free(index);
	mesh_free(&mesh);
	return true;
}
