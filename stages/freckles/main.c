/* freckles: find the freckles of an iris, and paint them over.
 * reads   work/iris/texture.exr, texture.json
 * writes  work/iris/freckles.exr, freckles.json, clean.exr
 */
#include "base/mem.h"
#include "iris/freckle/opts.h"
#include "freckles.h"

int main(int argc, char **argv)
{
	struct eye eye = { 0 };
	struct freckle_conf c = { 0 };
	struct stage stage;
	struct capture capture = { 0 };
	struct opt_each_list eye_of = { 0 };
	const struct opt opts[] = {
		EYE_OPTS(&eye),
		CAPTURE_OPTS(&eye_of),
		FRECKLE_OPTS(&c),
	};
	stage_start(&stage, "freckles", "find freckles and paint them over", argc, argv, COUNT(opts), opts);
	struct err err = { 0 };
	if (eye_check(&eye, &err) && capture_load(&capture, &stage, &eye_of, &err))
		for (int i = 0; i < capture.n_eyes; i++) {
			if (capture.n_eyes < 2 || file_exists(stage_path(&stage, "%s/texture.exr", capture.eyes[i].iris)))
				freckles_eye(&stage, &capture.eyes[i], &eye, &c, &err);
			else
				stage_skipped(&stage, "%s: no texture of its iris: none of its photographs could be used", capture.eyes[i].side);
		}
	capture_free(&capture);
	return stage_end(&stage, &err);
}
