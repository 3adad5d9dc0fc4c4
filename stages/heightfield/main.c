/* heightfield: coarse thickness of the iris stroma.
 * reads   IRIS/clean.exr, IRIS/texture.json
 * writes  IRIS/thickness.exr (Y mm, S its sigma mm)
 */
#include "base/mem.h"
#include "tissue/relief/opts.h"
#include "heightfield.h"

int main(int argc, char **argv)
{
	struct eye eye = { 0 };
	struct heightfield_stage_conf conf = { 0 };
	struct profile_conf *p = &conf.field.profile;
	struct opt_each_list eye_of = { 0 };
	const struct opt opts[] = {
		EYE_OPTS(&eye),
		CAPTURE_OPTS(&eye_of),
		OPT_REALS("id_mm", p->id, 3, 0.05, 2, "mm", "thickness ID1, ID2, ID3"),
		OPT_REALS("id_sigma_mm", p->id_sigma, 3, 0.001, 1, "mm", "their standard deviations"),
		OPT_REAL("id1_from_spur_mm", &p->id1_from_spur, 0.1, 2, "mm", "place of ID1"),
		OPT_REAL("id2_from_root_mm", &p->id2_from_root, 0.5, 4, "mm", "place of ID2"),
		OPT_REAL("id3_from_margin_mm", &p->id3_from_margin, 0.1, 2, "mm", "place of ID3"),
		OPT_REAL("margin_share", &p->margin_share, 0.1, 1, "", "thickness at the pupil's margin over ID3"),
		OPT_REAL("root_share", &p->root_share, 0.1, 1, "", "thickness at the root over ID1"),
		IRIS_OPTS(&p->root_beyond_limbus, &conf.pupil_radius),
		OPT_REAL("gain", &conf.field.gain, 0, 5, "", "ln thickness per ln luminance"),
		OPT_REAL("fine_mm", &conf.field.fine, 0.002, 0.5, "mm", "finest detail"),
		OPT_REAL("coarse_mm", &conf.field.coarse, 0.1, 5, "mm", "coarsest detail"),
		OPT_REAL("limit", &conf.field.limit, 1.1, 10, "", "largest factor of detail"),
		OPT_REAL("reach_mm", &conf.field.reach, 0.01, 2, "mm", "how far detail is carried where nothing was seen"),
	};
	struct stage stage;
	struct err err = { 0 };
	stage_start(&stage, "heightfield", "coarse thickness of the iris from a generic profile and the texture's detail", argc,
	            argv, COUNT(opts), opts);
	struct capture capture = { 0 };
	if (eye_check(&eye, &err) && capture_load(&capture, &stage, &eye_of, &err))
		for (int i = 0; i < capture.n_eyes && !err_is(&err); i++)
			if (!iris_left_out(&stage, &capture, &capture.eyes[i]))
				heightfield_stage(&stage, &capture.eyes[i], &eye, &conf, &err);
	capture_free(&capture);
	return stage_end(&stage, &err);
}
