#include "tests/peers/colmap_defaults.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "sfm/colmap/colmap.h"

static bool recall(struct spent *spent, const char *path)
{
	char *text;
	size_t size;
	struct err none = { 0 };
	if (!file_read(&text, &size, path, 1000, &none))
		return false;
	bool ok = sscanf(text, "%lf s wall, %lf s of processors", &spent->wall, &spent->cpu) == 2;
	free(text);
	return ok;
}

static bool run_all(struct spent *spent, const char *dir, const char *images, const char *times, struct err *err)
{
	char *db = mem_printf("%s/database.db", dir), *log = mem_printf("%s/colmap.log", dir);
	const char *const steps[][16] = {
		{ "colmap", "feature_extractor", "--database_path", db, "--image_path", images, "--ImageReader.single_camera", "1",
		  "--SiftExtraction.use_gpu", "0", 0 },
		{ "colmap", "exhaustive_matcher", "--database_path", db, "--SiftMatching.use_gpu", "0", 0 },
		{ "colmap", "mapper", "--database_path", db, "--image_path", images, "--output_path", dir, 0 },
	};
	setenv("QT_QPA_PLATFORM", "offscreen", 1);
	bool ok = file_mkdirs(dir, err) && file_remove(db, err);
	*spent = (struct spent){ 0 };
	for (int i = 0; i < COUNT(steps) && ok; i++) {
		struct spent s;
		ok = spent_run(&s, steps[i], log, err);
		*spent = (struct spent){ spent->wall + s.wall, spent->cpu + s.cpu };
	}
	char *text = mem_printf("%.1f s wall, %.1f s of processors\n", spent->wall, spent->cpu);
	ok = ok && file_write(times, text, strlen(text), err);
	free(text);
	free(db);
	free(log);
	return ok;
}

static void take(struct camera_rig *rig, const struct colmap_model *m)
{
	*rig = (struct camera_rig){ .cameras = mem_new((size_t)m->n_images, sizeof *rig->cameras), .n = m->n_images };
	for (int i = 0; i < m->n_images; i++) {
		const struct colmap_image *im = &m->images[i];
		struct rig_camera *c = &rig->cameras[i];
		double R[3][3];
		*c = (struct rig_camera){ .name = mem_printf("%.*s", (int)strcspn(im->name, "."), im->name), .file = mem_str(im->name),
			                      .has_pose = true, .residual_px = colmap_residual(m, i) };
		for (int k = 0; k < im->n_seen; k++)
			c->points += im->seen[k].point >= 0;
		colmap_rotation(R, im->q);
		for (int r = 0; r < 3; r++) {
			memcpy(c->cam_from_head[r], R[r], sizeof R[r]);
			c->cam_from_head[r][3] = im->t[r];
		}
	}
}

bool colmap_defaults(struct camera_rig *rig, struct spent *spent, const char *dir, const char *images, struct err *err)
{
	struct colmap_model m;
	char *times = mem_printf("%s/spent.txt", dir), *model = mem_printf("%s/0", dir);
	bool ok = (recall(spent, times) || run_all(spent, dir, images, times, err)) && colmap_load(&m, model, err);
	if (ok) {
		take(rig, &m);
		colmap_free(&m);
	}
	free(times);
	free(model);
	return ok;
}
