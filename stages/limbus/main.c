/* limbus: find the limbus and the pupil in every photograph, and how the eye stands to the camera.
 * reads   photos/
 * writes  work/limbus/NAME.json, NAME.png; NAME.edge.json (what was measured); of a photograph of both eyes NAME.left.json ...,
 *         NAME.right.json ...
 */
#include <math.h>

#include "base/mem.h"
#include "limbus.h"
#include "limbus/strip_net.h"
#include "opts.h"

int main(int argc, char **argv)
{
	stage_calm(argv);
	mem_hold();
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
		OPT_EACH("photo.*.mirrored", &o.photo_mirrored, 0, 0, 0, "", "yes: of a photograph of both eyes, the left one is on the left"),
		OPT_REAL("hint_sigma", &o.find.hint_sigma, 0.001, 0.5, "", "of photo.NAME.hint_px where no edge is near, of the radius"),
		OPT_REAL("drawn_sigma", &o.find.drawn_sigma, 0.0001, 0.2, "", "of photo.NAME.limbus_px, of the semi-axis"),
		LIMIT_PHOTO_OPT(&o.limit_mpx),
		OPT_REAL("min_radius", &o.find.seek.min_radius, 0.005, 0.3, "", "smallest limbus, share of the longer side"),
		OPT_REAL("max_radius", &o.find.seek.max_radius, 0.1, 1, "", "largest limbus, share of the shorter side"),
		OPT_REAL("seek_contrast", &o.find.seek.contrast, 0.02, 1, "", "Weber contrast of a fully supported edge"),
		OPT_INT("overlay_px", &o.overlay_px, 64, 8192, "px", "longer side of the picture of what was found, at most"),
		OPT_INT("candidates", &o.find.seek.candidates, 1, SEEK_MAX, "", "ellipses kept by the search"),
		OPT_REAL("search", &o.find.rim.search, 0.01, 0.3, "", "first edge search, share of the semi-axis"),
		OPT_REAL("measured_px", &o.find.rim.max_axis, 50, 10000, "px", "larger limbi are measured in a reduced picture"),
		OPT_INT("passes", &o.find.rim.passes, 3, 20, "", "of the step fit along the ring"),
		OPT_REAL("arc_rms", &o.find.rim.max_rms, 0.02, 1, "", "residual of a step, of its height, that is trusted"),
		OPT_REAL("arc_contrast", &o.find.rim.min_contrast, 0, 1, "", "height of a step, of the typical one's"),
		OPT_REAL("straying", &o.find.rim.straying, 0, 100, "", "variance of centre and size for that of residuals that neighbours share"),
		OPT_REAL("coarse_straying", &o.find.rim.coarse_straying, 1, 100, "", "how many times more a rough measure strays"),
		OPT_REAL("colour_gain", &o.find.rim.colour_gain, 1, 1000, "", "of colour over brightness, from which it measures sharp steps, too"),
		OPT_REAL("rough_gain", &o.find.rim.rough_gain, 1, 1000, "", "the same, of a rough measure"),
		OPT_REAL("irregularity", &o.find.rim.irregularity, 0, 1, "", "sigma that noise does not show, of the step's width"),
		PUPIL_OPTS(&o.find.pupil),
		OPT_REAL("tolerance", &o.find.tolerance, 0.01, 0.06, "", "share of the semi-axis: what is farther off is a gross error"),
		OPT_REAL("rough_tolerance", &o.find.rough_tolerance, 0.01, 0.06, "", "the widest to which a refused ellipse may be known"),
		OPT_REAL("rough_gross", &o.find.rough_gross, 0.001, 0.5, "", "chance of being farther off than that, beyond which it is not known so"),
		OPT_REAL("rough_used", &o.rough_used, 0, 0.06, "", "to which one must be, to be used where no photograph of the eye is better; 0: never"),
		OPT_REAL("max_gross", &o.find.max_gross, 0.001, 1, "", "chance of a gross error, beyond which it is refused"),
		OPT_REAL("sure_gross", &o.find.sure_gross, 0, 1, "", "chance below which votes of edges are not asked"),
		OPT_REAL("region_sigma", &o.find.region_sigma, 0.001, 0.5, "", "of the evidence's ellipse: centre and size, share of the semi-axis"),
		STRIP_OPTS(&o.find.strip_conf),
		TRIAL_OPTS(&o.find.trial),
		SAME_OPTS(&o.find.same),
		OPT_REAL("strip_sigma", &o.find.strip_sigma, 0, 0.2, "", "sigma of the strip's ellipse beside what its rays say, share of its semi-axis"),
		OPT_REAL("region_hidden", &o.find.region_hidden, 0, 20, "", "how many times more both are where no sclera lies beside it"),
		OPT_REAL("region_shape_sigma", &o.find.region_shape_sigma, 0.001, 0.5, "", "the same of its shape"),
		OPT_REAL("max_rms", &o.find.max_rms, 0.001, 0.2, "", "scatter of an edge near a hand's mark that is believed, of the semi-axis"),
		HAND_OPTS(&o.find.hand),
		FACE_OPTS(&o.find.face),
		OPT_REAL("face_roll", &o.face_roll_deg, 0, 90, "deg", "of the line through both, at most"),
		OPT_REAL("max_over", &o.find.max_over, 0, 1, "", "share of burnt pixels"),
		OPT_REAL("min_level", &o.find.min_level, 0, 1, "", "encoded brightness of the 90 % quantile"),
		OPT_REAL("pupil_offset_sigma", &o.pose.pupil_offset_sigma, 0.01, 2, "mm", "pupil centre off the axis"),
		OPT_REAL("iris_depth_sigma", &o.pose.depth_sigma, 0.01, 2, "mm", "iris plane off eye.iris_depth_mm"),
		OPT_REAL("pupil_floor", &o.pose.pupil_floor, 0, 0.2, "", "sigma of an irregular pupil's centre, of its axis"),
		OPT_REAL("aspect_mean", &o.pose.aspect_mean, 0.7, 1.2, "", "limbus: vertical / horizontal"),
		OPT_REAL("aspect_sigma", &o.pose.aspect_sigma, 0.001, 0.2, "", "its spread among people"),
		OPT_REAL("roll_sigma", &o.roll_sigma_deg, 0, 30, "deg", "of the limbus's axes against the picture's"),
		OPT_REAL("side_trust", &o.pose.side_trust, 0, 1, "", "of what the limbus's ramp and the iris' brightness say of the side to which it is tilted"),
		OPT_REAL("opening_arm", &o.pose.opening.arm, 1, 100, "mm", "from the limbus back to where it turns about, between the corners of the lids"),
		OPT_REAL("opening_sigma", &o.opening_sigma_deg, 0, 90, "deg", "of the direction that its place between them tells; 0: not asked"),
		OPT_REAL("opening_misled", &o.pose.opening.misled, 0.001, 1, "", "chance that it tells nothing"),
		OPT_REAL("face_apart", &o.face_apart_deg, -45, 45, "deg", "optical axes of both eyes, where they diverge: mean"),
		OPT_REAL("face_apart_sigma", &o.face_apart_sigma_deg, 0.1, 45, "deg", "of that"),
		OPT_REAL("face_level_sigma", &o.face_level_deg, 0.1, 45, "deg", "of how far one looks higher than the other"),
		OPT_REAL("face_squint", &o.pose.fellow.squint, 0, 1, "", "chance that both have nothing to do with each other"),
		OPT_REAL("tilt_sigma", &o.tilt_sigma_deg, 1, 1000, "deg", "how far eyes look past the lens"),
	};
	stage_start(&stage, "limbus", "find limbus, pupil and pose in every photograph", argc, argv, COUNT(opts), opts);
	struct err err = { 0 };
	struct limbus_kept kept = { 0 };
	o.find.face.roll = o.face_roll_deg * M_PI / 180;
	o.pose.roll_sigma = o.roll_sigma_deg * M_PI / 180;
	o.pose.tilt_sigma = o.tilt_sigma_deg * M_PI / 180;
	o.pose.opening.sigma = o.opening_sigma_deg * M_PI / 180;
	o.pose.fellow.apart = o.face_apart_deg * M_PI / 180;
	o.pose.fellow.apart_sigma = o.face_apart_sigma_deg * M_PI / 180;
	o.pose.fellow.level_sigma = o.face_level_deg * M_PI / 180;
	bool ok = eye_check(&o.eye, &err) && capture_list(&capture, &stage, &o.photo_eye, &err);
	ok = ok && limbus_measure(&kept, &stage, &capture, &o, &err) && limbus_fit_poses(&kept, &stage, &capture, &o, &err);
	occlusion_close(o.find.occlusion);
	odds_close(o.find.odds);
	strip_close(o.find.strip);
	evidence_close(o.find.net);
	limbus_kept_free(&kept);
	capture_free(&capture);
	return stage_end(&stage, &err);
}
