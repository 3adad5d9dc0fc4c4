/* relief: the iris' relief, sharpened until a rendering of it shows the photograph's detail.
 * reads   IRIS/clean.exr, IRIS/texture.json, IRIS/thickness.exr, IRIS/pigment.json, IRIS/light.exr
 * writes  IRIS/relief.exr (Y height mm, T thickness mm, S sigma of its detail mm), IRIS/relief.json
 */
#include "base/mem.h"
#include "stages/relief/relief_stage.h"

int main(int argc, char **argv)
{
	struct eye eye = { 0 };
	struct relief_stage_conf c = { 0 };
	struct opt_each_list eye_of = { 0 };
	const struct opt opts[] = {
		EYE_OPTS(&eye),
		CAPTURE_OPTS(&eye_of),
		RELIEF_OPTS(&c.relief, c.range),
		IRIS_OPTS(&c.root_beyond_limbus, &c.pupil_radius),
		OPT_BOOL("filter", &c.relief.filter, "sharpen; no: the coarse height field"),
		OPT_BOOL("shading", &c.shading, "the relief that explains the shading; no: the filtered coarse field, as the paper"),
		OPT_REAL("finest_mm", &c.infer.finest, 0.02, 0.2, "mm", "where the octaves of relief begin"),
		OPT_REAL("octave_sigma", &c.infer.most, 0.001, 2, "", "rms of ln thickness in an octave, at most"),
		OPT_REAL("response_error", &c.infer.response_error, 0, 1, "", "error of shading's response, relative"),
		OPT_REAL("light_error", &c.infer.light_error, 0, 1, "", "error of ln light that is reckoned, in an octave, rms"),
		OPT_REAL("edge_error", &c.infer.edge, 0, 10, "", "error of ln light that is spread at an edge, of what spreading changes"),
	};
	struct stage stage;
	struct err err = { 0 };
	stage_start(&stage, "relief", "sharpening filter of the iris' relief, by rendering and comparing", argc, argv, COUNT(opts),
	            opts);
	struct capture capture = { 0 };
	if (relief_conf_check(&c.relief, c.range, &err) && eye_check(&eye, &err) && capture_load(&capture, &stage, &eye_of, &err))
		for (int i = 0; i < capture.n_eyes && !err_is(&err); i++)
			if (!iris_left_out(&stage, &capture, &capture.eyes[i]))
				relief_stage(&stage, &capture.eyes[i], &eye, &c, &err);
	capture_free(&capture);
	return stage_end(&stage, &err);
}
