/* pigment: melanin of both layers of the iris.
 * reads   IRIS/clean.exr, IRIS/texture.json, IRIS/thickness.exr, photos/, work/limbus/
 * writes  IRIS/pigment.json, IRIS/light.exr (what white shows of its light there, and from where that comes)
 */
#include "anatomy/keys.h"
#include "anatomy/light.h"
#include "base/mem.h"
#include "tissue/relief/opts.h"
#include "stages/pigment/pigment_opts.h"

int main(int argc, char **argv)
{
	struct eye eye = { 0 };
	struct pigment_stage_conf c = { 0 };
	struct opt_each_list eye_of = { 0 };
	const struct opt opts[] = {
		EYE_OPTS(&eye), CAPTURE_OPTS(&eye_of),
		IRIS_OPTS(&c.root_beyond_limbus, &c.pupil_radius),
		OPT_EACH("photo.*.card_px", &c.card, 3, 0, 1e6, "px", "a grey card: x y radius"),
		OPT_CHOICE("light.illuminant", &c.illuminant, illuminant_names, "that the photograph was balanced for"),
		LIGHT_POLARISED_OPT(&c.fit.polarised),
		LIGHT_ENVIRONMENT_OPT(&c.light),
		LIMIT_PHOTO_OPT(&c.limit_mpx),
		PIGMENT_OPTS(&c),
	};
	struct stage stage;
	struct err err = { 0 };
	stage_start(&stage, "pigment", "melanin of the iris' two layers from its texture", argc, argv, COUNT(opts), opts);
	struct capture capture = { 0 };
	if (pigment_stage_check(&c, &err) && eye_check(&eye, &err) && capture_load(&capture, &stage, &eye_of, &err))
		for (int i = 0; i < capture.n_eyes && !err_is(&err); i++)
			if (!iris_left_out(&stage, &capture, &capture.eyes[i]))
				pigment_stage(&stage, &capture, i, &eye, &c, &err);
	capture_free(&capture);
	return stage_end(&stage, &err);
}
