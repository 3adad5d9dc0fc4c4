/* extrapolate: makes the rig of every character that transfer has registered.
 * reads   work/skin/model.json and matrices, targets/NAME.* (of a character with materials work/targets/NAME/character.ply),
 *         work/targets/NAME/registered.ply, barycentric.npz, registration.json
 *         (registration.json: subject_from_target [16] row-major similarity, mm to mm; target_unit_mm, subject_unit_mm. barycentric.npz:
 *         indptr, indices int32, data, confidence float32; rows are the vertices of targets/NAME and of registered.ply, which
 *         is in mm and the subject's axes)
 * writes  work/targets/NAME/rig.npz, skull.exr, skull_normal.exr, globe_left.exr, globe_right.exr
 */
#include "anatomy/keys.h"
#include "base/mem.h"
#include "stages/extrapolate/extrapolate.h"

int main(int argc, char **argv)
{
	struct extrapolate_conf conf = { 0 };
	struct rig_conf *r = &conf.rig;
	const struct opt opts[] = {
		OPT_INT("neighbours", &r->neighbours, 1, 64, "", "tracked vertices that an untracked one follows"),
		OPT_REALS("fade_mm", r->fade, 2, 0, 200, "mm", "from tracked skin: all of its motion up to the first, none from the second"),
		OPT_REALS("glue_mm", r->glue, 2, 0, 50, "mm", "from the globe at rest: distance kept up to the first, free from the second"),
		OPT_REAL("thickness_mm", &r->thickness, 0, 10, "mm", "least distance of skin from the globe, where it rests further away"),
		OPT_REAL("least_mm", &r->least, 0, 2, "mm", "the same of skin that lies on it"),
		OPT_REAL("lid_mm", &r->lid, 0, 20, "mm", "from the lid's margin: over which skin follows the margin itself; 0: nowhere"),
		OPT_REAL("lid_gap_mm", &r->lid_gap, 0, 50, "mm", "from the globe at rest: up to which skin is a lid"),
		OPT_REALS("corner_within_mm", r->within, 2, 0, 10, "mm", "from the ends of the eyeball seen: margins leave their arcs; inner, outer"),
		OPT_REALS("corner_beyond_mm", r->beyond, 2, 0, 10, "mm", "from the ends of the eyeball seen: corners of the lids; inner, outer"),
		OPT_REALS("breadth_mm", r->breadth, 2, 0, 5, "mm", "of a lid's margin, of half the hollow at a corner, at most; closed eyes show none of it"),
		OPT_REALS("tarsus_mm", r->tarsus, 2, 0, 40, "mm", "above the upper margin: skin that shuts with it, up to the first wholly, from the second not"),
		OPT_REAL("seal_mm", &r->seal, -1, 5, "mm", "closed lids overlap so much; below 0: they close as far as they were learnt to"),
		OPT_REAL("lining_mm", &r->lining, 0, 10, "mm", "that a lining goes on below lids whose mesh ends at their edges; 0: none"),
		OPT_REAL("caruncle_mm", &r->caruncle, 0, 6, "mm", "width of caruncle and plica on what is seen of the eyeball; 0: none"),
		OPT_REAL("min_confidence", &r->min_confidence, 0, 1, "", "of transfer, below which a vertex counts as untracked"),
		OPT_REAL("map_step_px", &r->map_step, 0.25, 32, "px", "texel of the skull map, in the video's pixels"),
		OPT_INT("globe_cells", &r->globe_cells, 8, 2048, "", "cells across the globe's map"),
		OPT_REAL("cornea_bulge", &r->cornea_bulge, 0, 2, "", "apex over radius below which a character's globe gets a cornea; 0: never"),
		OPT_INT("polar_px", &conf.polar_px, 16, 4096, "px", "rows of the globe map's picture"),
		OPT_REAL("limit_vertices", &conf.limit_vertices, 100, 1e8, "", "larger meshes are refused"),
		SUBJECT_UNIT_OPT(&conf.subject_unit),
		SUBJECT_EYE_OPTS(&conf.eye_radius, &conf.eye_center),
	};
	struct stage stage;
	struct err err = { 0 };
	struct file_list targets = { 0 };
	struct skin_model model = { 0 };
	struct rig_motion motion = { 0 };
	stage_start(&stage, "extrapolate", "rig characters: skin that was not tracked, the skull and the globes below it", argc, argv,
	            COUNT(opts), opts);
	if (stage_list(&stage, &targets, "targets", &err) && skin_model_load(&model, stage_path(&stage, "work/skin"), &err)) {
		rig_motion_of_model(&motion, &model);
		extrapolate_targets(&stage, &targets, &motion, &conf, &err);
	}
	rig_motion_free(&motion);
	skin_model_free(&model);
	file_list_free(&targets);
	return stage_end(&stage, &err);
}
