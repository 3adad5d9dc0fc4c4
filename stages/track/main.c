/* track: gaze, lids and skin of a video, followed frame by frame.
 * reads   video/, the subject's mesh (subject.ply, .obj or work/subject.ply), work/rig.json
 * writes  work/skin/: track_files (save.c), of expressions wrinkle_files (wrinkles.c)
 */
#include <malloc.h>

#include "base/mem.h"
#include "base/stage.h"
#include "stages/track/run.h"

/* Pictures of some MB come and go all the time, from several threads: memory that is given back to the system each time costs the fetching of its pages anew. */
static void keep_memory(void)
{
	enum { MIB = 1 << 20 };
	mallopt(M_ARENA_MAX, 1);
	mallopt(M_MMAP_THRESHOLD, 32 * MIB);
	mallopt(M_TRIM_THRESHOLD, 256 * MIB);
}

int main(int argc, char **argv)
{
	stage_calm(argv);
	keep_memory();
	static const char *const shown[] = { "both", "left", "right", 0 };  // enum track_shown
	struct track_conf c = { 0 };
	const struct opt opts[] = {
		EYE_OPTS(&c.eye),
		VIDEO_OPTS(&c.video),
		EYE_TRACK_OPTS(&c.eyes),
		SKIN_TRACK_OPTS(&c.skin),
		HEAD_FIND_OPTS(&c.head),
		HEAD_SHADE_OPTS(&c.shade),
		WRINKLE_OPTS(&c.wrinkle),
		CAMERA_FOCAL_OPTS(&c.camera),
		CAMERA_LENS_OPTS(&c.camera),
		SUBJECT_UNIT_OPT(&c.unit_mm),
		SUBJECT_LANDMARK_OPT(&c.landmark),
		SUBJECT_EYE_OPTS(&c.eye_radius, &c.eye_center),
		EXPRESSION_OPT(&c.expression),
		OPT_EACH("landmark_*", &c.landmark_px, 2, -1e5, 1e5, "px", "where a landmark is seen in the reference frame"),
		OPT_INT("reference_frame", &c.reference, -1, 10000000, "", "frame the mesh is laid on; -1: found"),
		OPT_CHOICE("shown", &c.alone, shown, "eyes that a video without a mesh shows"),
		OPT_INT("search_frames", &c.search, 1, 100000, "", "searched for a face at most"),
		OPT_REAL("distance_mm", &c.distance_mm, 50, 10000, "mm", "of the face from a camera of unknown focal length"),
		OPT_REAL("distance_sigma", &c.distance_sigma, 0, 1, "", "one standard deviation of that, as a share of it"),
		SETTLE_OPTS(&c),
		OPT_REALS("canthus_beyond", c.canthi.beyond, 4, -0.5, 0.5, "", "of the iris' radius: the eye's evidence ends so far within its corners (inner: outwards, downwards; outer)"),
		OPT_REALS("canthus_told_sigma", c.canthi.told_sigma, 4, 0.001, 1, "", "standard deviations of corners that the evidence tells, of the iris' radius"),
		OPT_REAL("canthus_mesh_sigma", &c.canthi.mesh_sigma, 0, 1, "", "that of the mesh's; 0: the evidence is not asked"),
		OPT_REAL("lids_beyond", &c.canthi.outline_beyond, -0.5, 0.5, "", "of the iris' radius: the eye's evidence ends so far within the lids' margins"),
		OPT_REAL("lids_told_sigma", &c.canthi.outline_sigma, 0.001, 1, "", "standard deviation of margins that the evidence tells, of the iris' radius"),
		OPT_REAL("canthus_most", &c.canthi.most, 0.01, 2, "", "apart by more, of the iris' radius, they are not one corner"),
		OPT_REAL("canthus_area", &c.canthi.least_area, 0, 20, "", "squares of the iris' radius that must show"),
		OPT_INT("lids_every", &c.lids.every, 0, 1000, "", "one frame in so many whose evidence the lids are drawn to; 0: none"),
		OPT_REAL("lids_most_px", &c.lids.most_px, 0, 1e4, "px", "radius of irises up to which they are"),
		OPT_REAL("lids_found_px", &c.lids.found_px, 0.01, 100, "px", "standard deviation of margins and corners that were followed"),
		OPT_REALS("lids_corner_sigma", c.lids.corner_sigma, 4, 0.001, 10, "", "those of the corners that the evidence tells in each frame"),
		OPT_REALS("lids_ends_sigma", c.lids.ends_sigma, 2, 0.001, 1, "", "lids_told_sigma at the inner and the outer end"),
		OPT_REALS("lids_ends_beyond", c.lids.ends_beyond, 2, -0.5, 0.5, "", "lids_beyond there"),
		OPT_REAL("meniscus_mm", &c.meniscus_mm, 0, 3, "mm", "that a lid's margin stands off the eye in its corners"),
		OPT_REAL("lid_sigma_mm", &c.lid_sigma_mm, 0, 5, "mm", "a margin's place, off in the same way in all frames"),
		OPT_REALS("kappa_deg", c.kappa, 2, -20, 20, "degrees", "line of sight against the optical axis: towards the nose, up"),
		OPT_REALS("kappa_sigma_deg", c.kappa_sigma, 2, 1e-3, 20, "degrees", "standard deviations of those"),
		OPT_REALS_UNSET("camera_frames", c.camera_frames, 2, 0, 1e9, "", "first and last frame in which the person looks into the camera"),
		OPT_INT("chunk_frames", &c.chunk, 0, 10000000, "", "followed frames that a killed run loses at most; 0: all"),
		OPT_INT("points", &c.points, 20, 20000, "", "of skin"),
		OPT_REAL("reach_mm", &c.reach_mm, 15, 200, "mm", "skin that is followed, round an eyeball's centre"),
		OPT_REAL("gap_px", &c.gap_px, 0, 50, "px", "least distance between two points"),
		OPT_REAL("cut", &c.cut, 0, 1, "", "share of the points that must be seen, or the clip was cut"),
		OPT_REAL("own_mm", &c.own_mm, 0.001, 10, "mm", "motion that a point of skin may have of its own"),
		OPT_REAL("astray_mm", &c.astray_mm, 0.001, 10, "mm", "from its neighbours' motion a point counts little; twice as far off it is not seen"),
		OPT_REAL("pose_robust_px", &c.still_pose_px, 0.05, 50, "px", "a point further off the head's motion counts little"),
	};
	struct stage stage;
	struct err err = { 0 };
	stage_start(&stage, "track", "gaze, lids and skin of a video, followed frame by frame", argc, argv, COUNT(opts), opts);
	c.video.threads = stage.threads;
	if (eye_check(&c.eye, &err))
		track_stage(&stage, &c, &err);
	return stage_end(&stage, &err);
}
