/* refraction: the refraction function f(P, w) -> K: where light enters the cornea on its way to the iris.
 * reads   nothing but the anatomy
 * writes  IRIS/refraction.exr
 */
#include <stdlib.h>

#include "base/mem.h"
#include "anatomy/capture.h"
#include "anatomy/eye.h"
#include "iris/refraction_file.h"

static void report(struct stage *stage, const struct refraction *f, const struct eye *eye)
{
	stage_note(stage, "%s, %d Newton steps, %ld bytes: K off by %.2g mm on average, %.2g mm at worst",
	           refraction_methods[f->method], f->steps, refraction_bytes(f), f->mean_mm, f->worst_mm);
	stage_figure(stage, "refraction_error_mean", f->mean_mm, "mm");
	stage_figure(stage, "refraction_error_worst", f->worst_mm, "mm");
	stage_figure(stage, "refraction_bytes", refraction_bytes(f), "B");
	stage_figure(stage, "refraction_steps", f->steps, "");
	if (eye->two_surface)
		stage_skipped(stage, "light is led to the iris through one surface (index %g): the posterior one is left out, which "
		              "moves it by 0.008 to 0.05 mm", eye->index);
}

static bool one_eye(struct stage *stage, const struct capture_eye *of, const struct eye *eye,
                    const struct refraction_conf *conf, struct err *err)
{
	char *out = mem_printf("%s/refraction.exr", of->iris);
	bool ok = stage_fresh(stage, out, 0, 0);
	if (!ok) {
		struct cornea cornea = eye_cornea(eye);
		struct refraction f;
		refraction_make(&f, &cornea, conf);
		ok = refraction_save(&f, stage_path(stage, "%s", out), stage_made_by(stage, 0, 0), err)
		     && stage_made(stage, out, 0, 0, err);
		if (ok)
			report(stage, &f, eye);
		refraction_free(&f);
	}
	free(out);
	return ok;
}

int main(int argc, char **argv)
{
	struct eye eye = { 0 };
	struct refraction_conf conf = { 0 };
	struct opt_each_list eye_of = { 0 };
	const struct opt opts[] = {
		EYE_OPTS(&eye),
		CAPTURE_OPTS(&eye_of),
		OPT_CHOICE("method", &conf.method, refraction_methods, "auto: the cheapest within error_mm"),
		OPT_REAL("error_mm", &conf.error_mm, 1e-5, 1, "mm", "error of K that is good enough"),
		OPT_INT("table_points", &conf.points, 2, 1000, "", "table: points on a radius of the iris"),
		OPT_INT("table_directions", &conf.directions, 4, 100000, "", "table: directions over the hemisphere"),
	};
	struct stage stage;
	struct err err = { 0 };
	stage_start(&stage, "refraction", "how light reaches the iris through the cornea", argc, argv, COUNT(opts), opts);
	struct capture capture = { 0 };
	conf.radius = eye.limbus_radius;
	conf.depth = eye.iris_depth;
	if (eye_check(&eye, &err) && capture_load(&capture, &stage, &eye_of, &err))
		for (int i = 0; i < capture.n_eyes && !err_is(&err); i++)
			one_eye(&stage, &capture.eyes[i], &eye, &conf, &err);
	capture_free(&capture);
	return stage_end(&stage, &err);
}
