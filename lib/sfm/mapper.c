#include "sfm/mapper.h"

#include <stdlib.h>

#include "base/gate_walk.h"
#include "base/mem.h"
#include "sfm/colmap/run.h"

static const char *const files[] = { "cameras.bin", "images.bin", "points3D.bin", "project.ini", "seal" };

void mapper_remove(struct stage *stage, const char *dir)
{
	struct err none = { 0 };
	for (int i = 0; i < COUNT(files); i++)
		file_remove(stage_path(stage, "%s/%s", dir, files[i]), &none);
	gate_rmdir(stage_path(stage, "%s", dir));
}

bool mapper_run(struct stage *stage, const struct views *views, const struct mapper_step *step, const struct calibrate_options *o,
               struct err *err)
{
	char *filter = mem_printf("%g", o->filter_px), *angle = mem_printf("%g", o->tri_deg), *rounds = mem_printf("%d", o->ba_rounds);
	char *least = mem_printf("%d", views->n_used < 10 ? 2 : 5), *matches = mem_printf("%d", o->min_matches);
	const char *refine = step->refine ? "1" : "0", *to = stage_path(stage, "%s", step->to);
	// One thread: its sums depend on the number of threads, and most of its work is not parallel anyway.
	const char *args[48] = { "--database_path", stage_path(stage, CALIBRATE_DIR "/database.db"),
		"--image_path", stage_path(stage, CALIBRATE_DIR "/pictures"), "--output_path", to, "--Mapper.num_threads", "1",
		"--Mapper.min_num_matches", matches, "--Mapper.min_model_size", least, "--Mapper.max_num_models", "5",
		"--Mapper.filter_max_reproj_error", filter, "--Mapper.filter_min_tri_angle", angle,
		"--Mapper.ba_global_max_refinements", rounds, "--Mapper.ba_refine_focal_length", refine,
		"--Mapper.ba_refine_extra_params", refine, "--Mapper.fix_existing_images", step->fixed ? "1" : "0" };
	int n = 0;
	while (args[n])
		n++;
	if (step->from) {
		args[n++] = "--input_path";
		args[n++] = stage_path(stage, "%s", step->from);
	}
	if (step->adjust_each) {
		args[n++] = "--Mapper.ba_global_images_freq";
		args[n++] = "1";
	}
	bool ok = file_mkdirs(to, err) && colmap_run(stage, "mapper", args, views->n_used, "cameras", err);
	free(filter);
	free(angle);
	free(rounds);
	free(least);
	free(matches);
	return ok;
}

