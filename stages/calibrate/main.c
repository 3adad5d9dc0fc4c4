/* calibrate: cameras and the subject's mesh from overlapping photographs.
 * reads   views/, photos/, video/
 * writes  work/rig.json, work/subject.ply, work/calibrate/
 */
#include <math.h>

#include "base/mem.h"
#include "register/transfer_opts.h"
#include "stages/calibrate/run.h"

int main(int argc, char **argv)
{
	static const char *const lenses[] = { "simple_radial", "radial", "opencv", 0 };
	struct calibrate_options o = { 0 };
	double nodes[NRICP_LEVELS], rounds[NRICP_LEVELS];
	struct stage stage;
	struct err err = { 0 };
	const struct opt opts[] = {
		CAMERA_FOCAL_OPTS(&o.camera),
		OPT_EACH("view.*.left_eye_px", &o.left_eye, 3, -1e6, 1e6, "px", "x y radius of the person's left iris in a view"),
		OPT_EACH("view.*.right_eye_px", &o.right_eye, 3, -1e6, 1e6, "px", "the same of the right one"),
		OPT_EACH("view.*.mouth_px", &o.mouth, 4, -1e6, 1e6, "px", "x y of the mouth's right corner, x y of its left one"),
		OPT_EACH("view.*.ruler_px", &o.ruler, 4, -1e6, 1e6, "px", "x y of one end of a length, x y of the other"),
		OPT_EACH("view.*.distance_mm", &o.distance, 1, 1, 1e6, "mm", "from the camera to the face in the middle of a view"),
		EYE_LIMBUS_RADIUS_OPT(&o.limbus_radius_mm),
		OPT_REAL_UNSET("ruler_mm", &o.ruler_mm, 1, 1e5, "mm", "the length named by view.*.ruler_px"),
		OPT_REAL_UNSET("marker_mm", &o.marker_mm, 1, 1e4, "mm", "side of the black square of printed markers"),
		LIMIT_PHOTO_OPT(&o.limit_mpx),
		VIDEO_OPTS(&o.video),
		OPT_INT("video_frames", &o.video_frames, 2, 1000, "", "frames of a video that are looked at, where there are no views"),
		OPT_INT("video_frames_beside", &o.video_frames_beside, 0, 1000, "", "the same beside views, for the video's lens"),
		OPT_INT("max_views", &o.max_views, 10, 2000, "", "of more, so many are taken"),
		OPT_REAL("same_level", &o.same_level, 0, 50, "levels", "a picture that differs less from the one before is left out"),
		OPT_INT("picture_px", &o.picture_px, 400, 10000, "px", "longer side of the pictures that are compared"),
		OPT_INT("features", &o.features, 200, 32768, "", "features of a picture, at most"),
		OPT_INT("first_octave", &o.first_octave, -1, 0, "", "-1: features are also sought between the pixels"),
		OPT_INT("overlap_features", &o.overlap.strongest, 50, 8192, "", "features that decide which pictures overlap"),
		OPT_INT("overlap_matches", &o.overlap.min_matches, 1, 1000, "", "matches among them that make a pair"),
		OPT_INT("overlap_best", &o.overlap.always, 1, 1000, "", "best pairs of a picture that are kept anyway"),
		OPT_INT("sequence_neighbours", &o.sequence_neighbours, 0, 100, "", "neighbours compared in a sequence"),
		OPT_REAL("max_ratio", &o.overlap.match.max_ratio, 0.3, 1, "", "angle to the best match over that to the second"),
		OPT_REAL("max_distance", &o.overlap.match.max_distance, 0.1, 1.5, "rad", "angle between matching features"),
		OPT_INT("min_matches", &o.min_matches, 8, 1000, "", "matches that make two pictures neighbours"),
		OPT_CHOICE("lens", &o.lens, lenses, "distortion that is sought"),
		OPT_REAL("filter_px", &o.filter_px, 0.5, 20, "px", "points that project worse are left out"),
		OPT_REAL("min_angle_deg", &o.tri_deg, 0.1, 20, "deg", "smallest angle under which a point is seen"),
		OPT_INT("adjustments", &o.ba_rounds, 1, 20, "", "rounds of a bundle adjustment"),
		OPT_REAL("regrow", &o.regrow, 0, 1, "", "share of new pictures from which on all cameras are found anew"),
		OPT_BOOL("find_eyes", &o.find_eyes, "eyes that are not named are looked for in the views"),
		OPT_REAL("eyes_apart_mm", &o.eyes_apart_mm, 30, 90, "mm", "between the pupils, where nothing else has a known length"),
		OPT_REAL("head_radius_mm", &o.head_radius_mm, 20, 1000, "mm", "half the head's height, where nothing has a known length"),
		OPT_INT("neighbours", &o.cloud.neighbours, 1, 20, "", "pictures each one is matched with densely"),
		OPT_REAL("best_angle_deg", &o.best_angle_deg, 1, 45, "deg", "angle between two such views that suits best"),
		OPT_INT("subject_px", &o.cloud.size_px, 100, 4000, "px", "the head's diameter in dense matching"),
		OPT_INT("max_range", &o.cloud.max_range, 32, 1024, "px", "disparities that are tried, at most"),
		OPT_REAL("voxel", &o.cloud.voxel, 0.001, 0.1, "", "points are averaged in cells of this edge, of the head's radius"),
		OPT_INT("min_pairs", &o.cloud.min_pairs, 1, 10, "", "pairs of pictures that have to agree on a point"),
		OPT_REAL("max_slant_deg", &o.max_slant_deg, 20, 89, "deg", "surfaces steeper than this are left to other views"),
		OPT_INT("block", &o.cloud.stereo.block, 3, 15, "px", "window of dense matching"),
		OPT_INT("uniqueness", &o.cloud.stereo.uniqueness, 0, 50, "%", "the best match undercuts the second by"),
		OPT_INT("left_right", &o.cloud.stereo.left_right, 0, 10, "px", "match from the other side"),
		OPT_INT("speckle", &o.cloud.stereo.speckle, 0, 10000, "px", "smaller patches of their own depth are left out"),
		OPT_INT("mesh_depth", &o.mesh_depth, 5, 13, "", "octree levels of the Poisson mesher"),
		OPT_REAL("mesh_trim", &o.mesh_trim, 0, 15, "", "levels below which its surface is guesswork and cut away"),
		OPT_INT("mesh_faces", &o.mesh_faces, 1000, 5000000, "", "triangles of the subject's mesh"),
		OPT_INT("mesh_min_points", &o.mesh_min_points, 100, 1000000, "", "fewer points make no mesh"),
		OPT_STR("template", &o.template, "a mesh in the capture folder that is laid onto the surface"),
		OPT_REAL("template_cells", &o.template_cells, 0, 100, "cells", "by which it may lie farther from the points than the surface"),
		TRANSFER_OPTS("template_", &o.transfer, nodes, rounds),
	};
	stage_start(&stage, "calibrate", "cameras and the person's mesh from overlapping photographs, with COLMAP", argc, argv,
	            COUNT(opts), opts);
	transfer_conf_take(&o.transfer, nodes, rounds);
	o.cloud.best_angle = o.best_angle_deg * M_PI / 180;
	o.cloud.max_slant = o.max_slant_deg * M_PI / 180;
	calibrate_run(&stage, &o, &err);
	return stage_end(&stage, &err);
}
