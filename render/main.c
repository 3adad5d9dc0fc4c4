/* render: pictures of the fitted eye, and the review page.
 * reads   IRIS/texture.exr, clean.exr, relief.exr, pigment.json, limbus/NAME.json, photos/
 * writes  RENDER/NAME_view, NAME_compare, front, three_quarter, turntable, contact_sheet; review/index.html
 */
#include "base/mem.h"
#include "render/options.h"

int main(int argc, char **argv)
{
	struct eye eye = { 0 };
	struct render_conf conf = { 0 };
	struct opt_each_list eye_of = { 0 };
	const struct opt opts[] = { EYE_OPTS(&eye), CAPTURE_OPTS(&eye_of), RENDER_OPTS(&conf) };
	struct stage stage;
	struct err err = { 0 };
	stage_start(&stage, "render", "pictures of the fitted eye and the page that shows everything", argc, argv, COUNT(opts),
	            opts);
	struct capture capture = { 0 };
	bool ok = eye_check(&eye, &err) && capture_load(&capture, &stage, &eye_of, &err);
	for (int i = 0; ok && i < capture.n_eyes; i++)
		ok = render_eye(&stage, &capture, i, &eye, &conf, &err);
	// The page is made even where a picture could not be: it says what is missing and why.
	struct err late = { 0 };
	if (!page_make(&stage, &capture, &conf, &late) && ok)
		err = late;
	capture_free(&capture);
	return stage_end(&stage, &err);
}
