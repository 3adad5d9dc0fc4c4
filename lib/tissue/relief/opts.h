/* opts: option rows that the stages of the tissue share. */
#ifndef TISSUE_RELIEF_OPTS_H
#define TISSUE_RELIEF_OPTS_H
#include "anatomy/capture.h"
#include "tissue/relief/relief.h"

/* r: struct relief_conf; range: double[2]. */
#define RELIEF_OPTS(r, range) \
	OPT_REALS("tissue.filter_mm", (r)->band, RELIEF_BANDS, 0.005, 2, "mm", "Gaussians between the filter's bands"), \
	OPT_REAL("tissue.relief_sigma", &(r)->relief_sigma, 0.01, 10, "", "prior: rms of ln thickness about the coarse field, each band"), \
	OPT_REAL("tissue.filter_pitch_mm", &(r)->pitch, 0.01, 0.5, "mm", "texels of the fit"), \
	OPT_REAL("tissue.occlusion", &(r)->occlusion, 0, 5, "", "how much hollows are darkened, of what Monte Carlo finds"), \
	OPT_REAL("tissue.occlusion_mm", &(r)->reach, 0.01, 1, "mm", "how far that reaches"), \
	OPT_REAL("tissue.light_error", &(r)->model_error, 0.01, 5, "", "error of ln luminance"), \
	OPT_REALS("tissue.thickness_mm", range, 2, 0.01, 3, "mm", "least and largest thickness")

/* root, pupil: double *, mm. */
#define IRIS_OPTS(root, pupil) \
	OPT_REAL("tissue.root_beyond_limbus_mm", root, 0, 1, "mm", "iris root beyond the limbus"), \
	OPT_REAL("tissue.pupil_mm", pupil, 0.5, 5, "mm", "pupil radius where none was found")

/* True, and reported as skipped, when this eye has no texture while the folder has other eyes. The missing texture of an only eye is an
 * error where it is read. */
static inline bool iris_left_out(struct stage *stage, const struct capture *capture, const struct capture_eye *eye)
{
	if (capture->n_eyes < 2 || file_exists(stage_path(stage, "%s/clean.exr", eye->iris)))
		return false;
	stage_skipped(stage, "%s: no texture of its iris: none of its photographs could be used", eye->side);
	return true;
}

/* Checks what ranges of single options cannot; copies the range into r. Returns false, err set. */
static inline bool relief_conf_check(struct relief_conf *r, const double range[2], struct err *err)
{
	for (int b = 1; b < RELIEF_BANDS; b++)
		if (!(r->band[b] > r->band[b - 1]))
			return err_set(err, "tissue.filter_mm = %g after %g: must ascend", r->band[b], r->band[b - 1]);
	if (!(range[1] > range[0]))
		return err_set(err, "tissue.thickness_mm = %g %g: must ascend", range[0], range[1]);
	r->low = range[0];
	r->high = range[1];
	return true;
}

#endif
