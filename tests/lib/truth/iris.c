#include "tests/lib/truth/iris.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_photo.h"
#include "iris/freckle/opts.h"
#include "iris/unrefract/opts.h"
#include "iris/balance_opts.h"
#include "limbus/evidence.h"
#include "limbus/occlusion.h"

static const double painted_extent = 6.4;  // mm, half-width of the renderer's maps

static void resolve(const char *stage, const char *quality, int n, const struct opt opts[])
{
	struct conf conf = { 0 };
	struct err err = { 0 };
	char *file = mem_printf("config/%s.conf", stage), *prefix = mem_printf("%s.", stage);
	if (!conf_load(&conf, "config/capture.conf", "", 0, &err) || !conf_load(&conf, file, prefix, 0, &err)) {
		fprintf(stderr, "%s (run from the top of the checkout)\n", err.msg);
		exit(1);
	}
	conf_add(&conf, "quality", quality);
	if (!opt_resolve(stage, n, opts, &conf, &err)) {
		fprintf(stderr, "%s\n", err.msg);
		exit(1);
	}
	opt_free(n, opts);
	conf_free(&conf);
	free(file);
	free(prefix);
}

static struct unrefract_conf read_confs(struct balance_conf *white, const char *quality)
{
	struct unrefract_conf c = { 0 };
	bool write_map;
	const struct opt opts[] = { UNREFRACT_OPTS(&c), BALANCE_OPTS(white), OPT_BOOL("write_map", &write_map, "") };
	resolve("unrefract", quality, COUNT(opts), opts);
	return c;
}

struct balance_conf iris_balance_conf(void)
{
	struct balance_conf white;
	read_confs(&white, "review");
	return white;
}

struct unrefract_conf iris_unrefract_conf(const char *quality)
{
	struct balance_conf white;
	return read_confs(&white, quality);
}

struct freckle_conf iris_freckle_conf(const char *quality)
{
	struct freckle_conf c = { 0 };
	const struct opt opts[] = { FRECKLE_OPTS(&c) };
	resolve("freckles", quality, COUNT(opts), opts);
	return c;
}

bool iris_texture(struct unrefract_texture *texture, struct unrefract_view *view, struct fit *fit,
                  const struct truth *truth, const struct unrefract_conf *conf, struct err *err)
{
	struct photo photo = { 0 };
	struct evidence_net *net;
	*fit = truth_fit(truth);
	*view = (struct unrefract_view){ .name = truth->name };
	if (!photo_load(&photo, truth->photo, 100, err) || !evidence_open(&net, "config/evidence.onnx", err))
		return false;
	struct occlusion_net *hides;
	if (!occlusion_open(&hides, "config/occlusion.onnx", err)) {
		evidence_close(net);
		return false;
	}
	struct occlusion *hidden = mem_new(1, sizeof *hidden);
	struct evidence evidence = { 0 };
	struct balance_conf white = iris_balance_conf();
	bool ok = evidence_window(&evidence, net, &photo, fit->limbus.cx, fit->limbus.cy, fit->limbus.a, err);
	if (ok)
		view->white = balance_sclera(&photo, fit, &evidence, &white);
	ok = ok && occlusion_read(hidden, hides, &photo, &evidence, &fit->limbus, err);
	view->occlusion = hidden;
	ok = ok && unrefract_survey(view, &photo, fit, &evidence, 0, &truth->eye, conf, err);
	evidence_free(&evidence);
	view->occlusion = 0;
	free(hidden);
	occlusion_close(hides);
	evidence_close(net);
	if (!ok)
		return false;
	unrefract_align(1, view, conf);
	*texture = unrefract_begin(unrefract_size(1, view, &truth->eye, conf), &truth->eye, view, conf);
	unrefract_add(texture, view, &photo, &truth->eye, conf);
	unrefract_finish(texture, &truth->eye);
	photo_free(&photo);
	return true;
}

bool iris_painted(struct image *rgbw, double *extent, const struct truth *truth, const char *dir, int size)
{
	char *path = mem_printf("%s/iris_texture.png", dir);
	struct err err = { 0 };
	uint8_t *px;
	int width, height;
	bool ok = picture_read(&px, &width, &height, path, 20, &err);
	free(path);
	if (!ok)
		return false;
	uint8_t *small = cv_resize8(px, width, height, 3, size, size);
	*rgbw = image_new(size, size, 4);
	*extent = painted_extent;
	for (int y = 0; y < size; y++)
		for (int x = 0; x < size; x++) {
			double mm = 2 * painted_extent / size, r = hypot((x + 0.5) * mm - painted_extent, (y + 0.5) * mm - painted_extent);
			float *p = image_at(rgbw, x, y);
			for (int c = 0; c < 3; c++)
				p[c] = linear_from_srgb(small[3 * ((long)y * size + x) + c] / 255.0f);
			p[3] = r > truth->pupil_radius + 0.12 && r < truth->iris_radius;
		}
	free(small);
	free(px);
	return true;
}

uint8_t *iris_freckle_mask(const struct truth *truth, const char *dir, int size, double extent, bool turned)
{
	char *path = mem_printf("%s/freckle_mask.png", dir);
	struct err err = { 0 };
	uint8_t *px, *mask = 0;
	int width, height;
	if (picture_read(&px, &width, &height, path, 20, &err)) {
		mask = mem_new((size_t)size * (size_t)size, 1);
		double c = cos(truth->turn), s = turned ? sin(truth->turn) : 0, mm = 2 * extent / size;
		c = turned ? c : 1;
		for (int y = 0; y < size; y++)
			for (int x = 0; x < size; x++) {
				double px_mm = 2 * painted_extent / width, u = (x + 0.5) * mm - extent, v = (y + 0.5) * mm - extent;
				int col = (int)floor((c * u + s * v + painted_extent) / px_mm);
				int row = (int)floor((-s * u + c * v + painted_extent) / px_mm);
				if (col >= 0 && col < width && row >= 0 && row < height)
					mask[(long)y * size + x] = px[3 * ((long)row * width + col)] > 127;
			}
		free(px);
	}
	free(path);
	return mask;
}

double iris_freckle_overlap(const struct freckles *found, const uint8_t *painted, const struct image *rgbw)
{
	long both = 0, any = 0;
	for (long i = 0; i < (long)found->size * found->size; i++) {
		bool a = found->opacity[i] >= 0.5f, b = painted[i];
		if (rgbw->px[4 * i + 3] > 0.05f) {
			both += a && b;
			any += a || b;
		}
	}
	return any ? (double)both / (double)any : NAN;
}
