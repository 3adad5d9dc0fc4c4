#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "rig/hair/impl.h"

void hairs_grow(struct hairs *hairs, const struct rig *rig, const bool *shown, const struct hair_conf *conf)
{
	int n = 0, *face = mem_new((size_t)rig->n_faces + 1, sizeof *face);
	int32_t (*faces)[3] = mem_new((size_t)rig->n_faces + 1, sizeof *faces);
	struct rng rng = { 77 };
	*hairs = (struct hairs){ 0 };
	for (int i = 0; i < rig->n_faces; i++)
		if (rig->part[rig->faces[i][0]] == RIG_SKIN && (!shown || shown[i])) {
			memcpy(faces[n], rig->faces[i], sizeof *faces);
			face[n++] = i;
		}
	struct ray_scene *skin = ray_scene_new(rig->n, (const float(*)[3])rig->rest, n, (const int32_t(*)[3])faces);
	const struct front front[2] = { { rig, skin, face, 0, rig->globe[0].radius / 12 }, { rig, skin, face, 1, rig->globe[1].radius / 12 } };
	for (int side = 0; side < 2; side++) {
		struct front_opening opening;
		if (!front_open(&opening, &front[side]))
			continue;
		hairs_grow_lashes(hairs, &front[side], &opening, conf, &rng);
		hairs_find_rims(hairs, &front[side], &opening);
	}
	if (conf->film)
		memcpy(hairs->brow_rgb, conf->film->rgb, sizeof hairs->brow_rgb);
	for (int side = 0; side < 2; side++)
		hairs_grow_brow(hairs, &front[side], conf, &rng);
	if (conf->lash_mm > 0)
		hairs_turn_out(hairs, front, skin);
	ray_scene_free(skin);
	free(face);
	free(faces);
}
