/* unrefract: the iris without its cornea, all photographs of an eye merged.
 * reads   photos/, work/limbus/NAME.json
 * writes  work/iris/texture.exr, texture.json; with write_map, NAME.map.exr
 */
#include "anatomy/keys.h"
#include "base/mem.h"
#include "iris/unrefract/opts.h"
#include "iris/balance_opts.h"
#include "unrefract.h"

int main(int argc, char **argv)
{
	struct eye eye = { 0 };
	struct unrefract_conf c = { 0 };
	struct stage stage;
	struct capture capture = { 0 };
	struct opt_each_list eye_of = { 0 };
	struct balance_conf white = { 0 };
	struct run run = { &stage, &capture, &eye, &c, &white, 0, false };
	const struct opt opts[] = {
		EYE_OPTS(&eye),
		CAPTURE_OPTS(&eye_of),
		UNREFRACT_OPTS(&c),
		BALANCE_OPTS(&white),
		LIMIT_PHOTO_OPT(&run.limit_mpx),
		OPT_BOOL("write_map", &run.write_map, "write NAME.map.exr"),
	};
	stage_start(&stage, "unrefract", "unrefract the iris: see it without its cornea", argc, argv, COUNT(opts), opts);
	struct err err = { 0 };
	if (balance_conf_check(&white, &err) && eye_check(&eye, &err) && capture_load(&capture, &stage, &eye_of, &err))
		for (int i = 0; i < capture.n_eyes; i++)
			unrefract_eye(&run, i, &err);
	capture_free(&capture);
	return stage_end(&stage, &err);
}
