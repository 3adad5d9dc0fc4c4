/* What hides an iris: cells and places, damaged networks, windows mirrored in eyes of another renderer, mirrored photographs. */
#include "base/file.h"
#include "base/mem.h"
#include "image/colour.h"
#include "limbus/occlusion.h"
#include "math/rng.h"
#include "tests/lib/scenes/synth_eye.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

static const char *const net_path = "config/occlusion.onnx";

/* A photograph whose red grows to the right and whose green grows downwards. */
static void test_places(void **state)
{
	(void)state;
	enum { WIDE = 400, HIGH = 300 };
	const struct ellipse e = { 210, 140, 80, 64, 0.5 };
	uint8_t *px = mem_new(3UL * WIDE * HIGH, 1);
	for (int i = 0; i < WIDE * HIGH; i++) {
		px[3 * i] = (uint8_t)(i % WIDE / 2);
		px[3 * i + 1] = (uint8_t)(i / WIDE / 2);
	}
	struct photo photo = photo_of_bytes(px, WIDE, HIGH);
	float zero[EVIDENCE_CLASSES] = { 0 };
	struct evidence none = { .width = 1, .height = 1, .scale = 1000 };
	for (int k = 0; k < EVIDENCE_CLASSES; k++)
		none.plane[k] = &zero[k];
	float (*seen)[OCCLUSION_SIDE][OCCLUSION_SIDE] = mem_array(OCCLUSION_SEEN, sizeof *seen);
	occlusion_sample(seen, &photo, &none, &e);
	for (int j = 8; j < OCCLUSION_SIDE; j += 16)
		for (int i = 8; i < OCCLUSION_SIDE; i += 16) {
			double p[2], t;
			const double u = OCCLUSION_REACH * (2 * (i + 0.5) / OCCLUSION_SIDE - 1), v = OCCLUSION_REACH * (2 * (j + 0.5) / OCCLUSION_SIDE - 1), r = hypot(u, v);
			occlusion_place(p, &e, u, v);
			assert_true(fabs(255 * seen[0][j][i] - p[0] / 2) < 0.8 && fabs(255 * seen[1][j][i] - p[1] / 2) < 0.8);
			occlusion_place(p, &e, u / r, v / r);
			assert_true(fabs(ellipse_distance(&t, &e, p)) < 1e-9);
		}
	free(seen);
	photo_free(&photo);
	free(px);
}

static void test_files(void **state)
{
	(void)state;
	struct occlusion_net *net;
	struct err err = { 0 };
	char *data;
	size_t size;
	assert_false(occlusion_open(&net, "config/none.onnx", &err));
	ERR_HAS(err, "config/none.onnx");
	err = (struct err){ 0 };
	assert_false(occlusion_open(&net, "config/strip.onnx", &err));  // a network of another kind
	ERR_HAS(err, "config/strip.onnx");
	occlusion_close(0);
	assert_true(file_read(&data, &size, net_path, 1 << 22, &err));
	for (size_t i = 1; i < 8; i++) {
		err = (struct err){ 0 };
		assert_false(occlusion_open(&net, scratch_write("damaged.onnx", data, i * size / 8), &err));
		ERR_HAS(err, "damaged");
	}
	free(data);
}

/* A window of four panes, in units of the limbus about its centre. */
struct window { double at[2], half[2], lean; float light[3]; };

static bool in_window(const struct window *w, double u, double v)
{
	const double x = (u - w->at[0] - w->lean * (v - w->at[1])) / w->half[0], y = (v - w->at[1]) / w->half[1];
	return fabs(x) < 1 && fabs(y) < 1 && fabs(x) > 0.08 && fabs(y) > 0.08;
}

/* Adds its light, white is 1, to what the photograph shows; mirrored: to the mirror image. */
static struct photo with_window(const struct photo *photo, const struct ellipse *e, const struct window *w, bool mirrored)
{
	struct photo out = *photo;
	out.rgb = mem_array(3UL * (size_t)photo->width * (size_t)photo->height, sizeof *out.rgb);
	for (int y = 0; y < photo->height; y++)
		for (int x = 0; x < photo->width; x++) {
			const bool in = in_window(w, (x + 0.5 - e->cx) / e->a, (y + 0.5 - e->cy) / e->a);
			const long from = 3L * (y * photo->width + x), to = 3L * (y * photo->width + (mirrored ? photo->width - 1 - x : x));
			for (int c = 0; c < 3; c++) {
				const float v = linear_from_srgb((float)photo->rgb[from + c] / 65535) + (in ? w->light[c] : 0);
				out.rgb[to + c] = (uint16_t)(65535 * srgb_from_linear(fminf(v, 1)) + 0.5F);
			}
		}
	return out;
}

struct nets { struct evidence_net *evidence; struct occlusion_net *net; };

static void read_eye(struct occlusion *out, const struct nets *nets, const struct photo *photo, const struct ellipse *e)
{
	struct evidence evidence;
	struct err err = { 0 };
	assert_true(evidence_window(&evidence, nets->evidence, photo, e->cx, e->cy, e->a, &err));
	assert_true(occlusion_read(out, nets->net, photo, &evidence, e, &err));
	evidence_free(&evidence);
}

/* Means of the chance of a reflection over what the window covers and over the rest of the disc; away from the window's edges. */
static void means(double mean[2], const struct occlusion *o, const struct ellipse *e, const struct window *w)
{
	int n[2] = { 0 };
	mean[0] = mean[1] = 0;
	for (double v = -0.9; v < 0.9; v += 0.04)
		for (double u = -0.9; u < 0.9; u += 0.04) {
			const bool in = in_window(w, u, v), same = in == in_window(w, u + 0.05, v) && in == in_window(w, u - 0.05, v) && in == in_window(w, u, v + 0.05) && in == in_window(w, u, v - 0.05);
			if (hypot(u, v) > 0.88 || !same)
				continue;
			mean[!in] += occlusion_at(o, OCCLUSION_MIRROR, e->cx + u * e->a, e->cy + v * e->a);
			n[!in]++;
		}
	mean[0] /= n[0];
	mean[1] /= n[1];
}

static void test_windows(void **state)
{
	(void)state;
	struct nets nets;
	struct err err = { 0 };
	struct occlusion *o = mem_array(3, sizeof *o);
	struct rng rng = { 5 };
	double found = 0, lost = 0, plain = 0;
	int n = 0;
	if (!evidence_open(&nets.evidence, "config/evidence.onnx", &err) || !occlusion_open(&nets.net, net_path, &err))
		fail_msg("%s", err.msg);
	for (int i = 3; i < SYNTH_GRID; i += SANITISED ? 90 : 15, n++) {
		struct synth_eye eye = synth_eye_grid(i);
		struct synth_truth truth;
		eye.glints = 0;
		eye.occlusion = fmin(eye.occlusion, 0.15);
		struct photo photo = synth_eye_render(&eye, &truth);
		const float much = (float)(0.05 + 0.3 * rng_uniform(&rng));
		const struct window w = { { 0.5 * rng_uniform(&rng) - 0.25, -0.4 * rng_uniform(&rng) }, { 0.2 + 0.15 * rng_uniform(&rng), 0.2 + 0.15 * rng_uniform(&rng) },
			                      0.4 * rng_uniform(&rng) - 0.2, { much, 1.05F * much, 1.2F * much } };
		struct ellipse mirrored = truth.limbus;
		mirrored.cx = photo.width - mirrored.cx;
		mirrored.angle = -mirrored.angle;
		struct photo shown[2] = { with_window(&photo, &truth.limbus, &w, false), with_window(&photo, &truth.limbus, &w, true) };
		double mean[2];
		read_eye(&o[0], &nets, &shown[0], &truth.limbus);
		read_eye(&o[1], &nets, &shown[1], &mirrored);
		read_eye(&o[2], &nets, &photo, &truth.limbus);
		means(mean, &o[0], &truth.limbus, &w);
		found += mean[0];
		lost += mean[1];
		means(mean, &o[2], &truth.limbus, &w);
		plain += mean[0];
		for (int k = 0; k < OCCLUSION_CELLS * OCCLUSION_CELLS; k++)
			for (int c = 0; c < OCCLUSION_CLASSES; c++) {
				const int x = k % OCCLUSION_CELLS, y = k / OCCLUSION_CELLS;
				assert_true(fabsf(o[0].p[c][y][x] - o[1].p[c][y][OCCLUSION_CELLS - 1 - x]) < 0.02F);
			}
		for (int k = 0; k < 2; k++)
			free(shown[k].rgb);
		photo_free(&photo);
	}
	print_message("a reflection's chance: %.2f in windows, %.2f without them there, %.2f elsewhere\n", found / n, plain / n, lost / n);
	assert_true(found / n > 0.75);
	assert_true(plain / n < 0.15 && lost / n < 0.15);
	evidence_close(nets.evidence);
	occlusion_close(nets.net);
	free(o);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(test_places), SCRATCH_TEST(test_files), cmocka_unit_test(test_windows) };
	return cmocka_run_group_tests(tests, 0, 0);
}
