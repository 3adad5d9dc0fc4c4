/* Wrinkle maps of a character that fold with its expressions. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "draw/face/wrinkle_map.h"
#include "draw/web/face_impl.h"
#include "draw/web/map.h"
#include "draw/web/packed.h"
#include "model/model.h"

/* Each vertex's place in the wrinkle maps, in 1/16 px from their corner. */
static json_t *places(const struct web_face *f, const struct wrinkle_maps *maps)
{
	const struct portrait_mesh *m = &f->portrait->mesh;
	int n = f->n_shown;
	uint16_t *at = mem_array((size_t)n * 2 + 1, sizeof *at);
	for (int i = 0; i < n; i++)
		for (int c = 0; c < 2; c++) {
			double px = f->order[i] < m->n ? m->home[f->order[i]][c] - (c ? maps->y0 : maps->x0) : 0;
			at[2 * i + c] = (uint16_t)lrint(fmin(fmax(16 * px, 0), 65535));
		}
	json_t *out = packed_json(at, (size_t)n * 2 * sizeof *at, 2 * sizeof *at, 2 * sizeof *at);
	free(at);
	return out;
}

bool web_put_folds(json_t *out, const struct web_face *f, struct err *err)
{
	const struct wrinkle_maps *maps = f->portrait->wrinkles;
	enum { FOLDS = 8 };
	int of[FOLDS], n_folds = 0;
	json_t *follows = json_array();
	for (int i = 0; maps && i < maps->n && n_folds < FOLDS; i++)
		if (maps->folds[i] && f->portrait->wrinkle_input[i] >= 0) {
			of[n_folds++] = i;
			json_array_append_new(follows, json_integer(f->portrait->wrinkle_input[i] - SKIN_EYE_INPUTS));
		}
	json_t *map = n_folds ? web_map_folds(&maps->map, n_folds, of, err) : 0;
	if (map) {
		const double *row = f->rig->camera.from_target[0];
		double corner[] = { maps->map.width, maps->map.height }, subject_mm = sqrt(row[0] * row[0] + row[1] * row[1] + row[2] * row[2]), px = maps->px_per_mm * subject_mm;
		json_object_set_new(out, "folds", json_pack("{s:o,s:O,s:o,s:o,s:f,s:f}", "map", map, "follows", follows, "size", json_numbers(2, corner), "home", places(f, maps),
		                                            "subject_mm", subject_mm, "px", px));
	}
	json_decref(follows);
	return map || !n_folds;
}
