/* limbus: find the limbus and the pupil in every photograph, and how the eye stands to the camera.
 * reads   photos/
 * writes  work/limbus/NAME.json, NAME.png; NAME.edge.json (what was measured)
 */
#include "base/mem.h"
#include "limbus.h"

int main(int argc, char **argv)
{
	struct limbus_options o = { 0 };
	struct stage stage;
	struct capture capture = { 0 };
	const struct opt opts[] = {
		EYE_OPTS(&o.eye),
		CAPTURE_OPTS(&o.photo_eye),
		CAMERA_FOCAL_OPTS(&o.camera),
		CAMERA_LENS_OPTS(&o.camera),
		OPT_EACH("photo.*.focal_px", &o.photo_focal, 1, 10, 1e7, "px", "focal length of one photograph"),
		OPT_EACH("photo.*.center_px", &o.photo_center, 2, -1e6, 1e6, "px", "principal point of one photograph"),
		OPT_EACH("photo.*.hint_px", &o.photo_hint, 3, -1e6, 1e6, "px", "x y radius: where the limbus is"),
		OPT_EACH("photo.*.limbus_px", &o.photo_limbus, 5, -1e6, 1e6, "", "cx cy a b angle_deg: the limbus, drawn by hand"),
		OPT_REAL("hint_sigma", &o.find.hint_sigma, 0.001, 0.5, "", "of photo.NAME.hint_px where no edge is near, of the radius"),
		OPT_REAL("drawn_sigma", &o.find.drawn_sigma, 0.0001, 0.2, "", "of photo.NAME.limbus_px, of the semi-axis"),
		LIMIT_PHOTO_OPT(&o.limit_mpx),
		OPT_REAL("min_radius", &o.find.seek.min_radius, 0.005, 0.3, "", "smallest limbus, share of the longer side"),
		OPT_REAL("max_radius", &o.find.seek.max_radius, 0.1, 1, "", "largest limbus, share of the shorter side"),
		OPT_REAL("seek_contrast", &o.find.seek.contrast, 0.02, 1, "", "Weber contrast of a fully supported edge"),
		OPT_INT("overlay_px", &o.overlay_px, 64, 8192, "px", "longer side of the picture of what was found, at most"),
		OPT_INT("candidates", &o.find.seek.candidates, 1, SEEK_MAX, "", "ellipses kept by the search"),
		OPT_REAL("search", &o.find.rim.search, 0.01, 0.3, "", "first edge search, share of the semi-axis"),
		OPT_REAL("arc_rms", &o.find.rim.max_rms, 0.02, 1, "", "residual of a step, of its height, that is trusted"),
		OPT_REAL("arc_contrast", &o.find.rim.min_contrast, 0, 1, "", "height of a step, of the typical one's"),
		OPT_REAL("irregularity", &o.find.rim.irregularity, 0, 1, "", "sigma that noise does not show, of the step's width"),
		OPT_REAL("pupil_contrast", &o.find.pupil.min_contrast, 0.02, 1, "", "Weber contrast of pupil and iris"),
		OPT_REAL("pupil_coverage", &o.find.pupil.min_coverage, 0.1, 1, "", "share of the pupil's margin seen"),
		OPT_REAL("min_coverage", &o.find.min_coverage, 0.1, 1, "", "share of the limbus that must be seen"),
		OPT_REAL("min_contrast", &o.find.min_contrast, 0.01, 1, "", "Weber contrast of sclera and iris"),
		OPT_REAL("max_blur", &o.find.max_blur, 0.01, 0.5, "", "width of the step, share of the semi-axis"),
		OPT_REAL("max_rms", &o.find.max_rms, 0.001, 0.2, "", "scatter of the edge, share of the semi-axis"),
		OPT_REAL("max_sigma", &o.find.max_sigma, 0.001, 0.2, "", "sigma of the ellipse, share of the semi-axis"),
		OPT_REAL("max_flank_rms", &o.find.max_flank_rms, 0.001, 0.2, "", "max_rms where the limbus was found by its sides"),
		OPT_REAL("max_flank_sigma", &o.find.max_flank_sigma, 0.001, 0.2, "", "max_sigma where the limbus was found by its sides"),
		OPT_REAL("min_flank_coverage", &o.find.min_flank_coverage, 0.1, 1, "", "min_coverage where the limbus was found by its sides"),
		OPT_REAL("max_over", &o.find.max_over, 0, 1, "", "share of burnt pixels"),
		OPT_REAL("min_level", &o.find.min_level, 0, 1, "", "encoded brightness of the 90 % quantile"),
		OPT_REAL("pupil_offset_sigma", &o.pose.pupil_offset_sigma, 0.01, 2, "mm", "pupil centre off the axis"),
		OPT_REAL("iris_depth_sigma", &o.pose.depth_sigma, 0.01, 2, "mm", "iris plane off eye.iris_depth_mm"),
		OPT_REAL("pupil_floor", &o.pose.pupil_floor, 0, 0.2, "", "sigma of an irregular pupil's centre, of its axis"),
		OPT_REAL("aspect_mean", &o.pose.aspect_mean, 0.7, 1.2, "", "limbus: vertical / horizontal"),
		OPT_REAL("aspect_sigma", &o.pose.aspect_sigma, 0.001, 0.2, "", "its spread among people"),
	};
	stage_start(&stage, "limbus", "find limbus, pupil and pose in every photograph", argc, argv, COUNT(opts), opts);
	struct err err = { 0 };
	struct limbus_kept kept = { 0 };
	bool ok = eye_check(&o.eye, &err) && capture_load(&capture, &stage, &o.photo_eye, &err);
	ok = ok && limbus_measure(&kept, &stage, &capture, &o, &err) && limbus_fit_poses(&kept, &stage, &capture, &o, &err);
	photo_free(&kept.photo);
	capture_free(&capture);
	return stage_end(&stage, &err);
}
