/* The network's evidence: a damaged file, shapes, sums, threads, a plain eye, its mirror image. */
#include <omp.h>

#include "base/file.h"
#include "base/mem.h"
#include "limbus/evidence.h"
#include "math/rng.h"
#include "tests/evidence/scene.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

static const char *const net_path = "config/evidence.onnx";

static struct evidence_net *open_net(void)
{
	struct evidence_net *net;
	struct err err = { 0 };
	if (!evidence_open(&net, net_path, &err))
		fail_msg("%s", err.msg);
	return net;
}

static struct photo blank(int width, int height)
{
	return (struct photo){ .width = width, .height = height, .bits = 8, .rgb = mem_new((size_t)width * (size_t)height * 3, sizeof(uint16_t)) };
}

static void put(struct photo *photo, int x, int y, const double rgb[3])
{
	for (int c = 0; c < 3; c++)
		photo->rgb[3 * (y * photo->width + x) + c] = (uint16_t)(65535 * fmin(fmax(rgb[c], 0), 1));
}

/* Made by hand: a lens-shaped opening in skin, white, with a blue iris of 40 px radius at the middle of 320 x 240 px, its pupil a
 * third of it. */
static struct photo plain_eye(void)
{
	static const double skin[3] = { 0.80, 0.62, 0.53 }, white[3] = { 0.90, 0.88, 0.86 }, iris[3] = { 0.35, 0.47, 0.58 }, pupil[3] = { 0.04, 0.04, 0.05 },
	                    edge[3] = { 0.45, 0.28, 0.22 };
	struct photo photo = blank(320, 240);
	struct rng rng = { 3 };
	for (int y = 0; y < 240; y++)
		for (int x = 0; x < 320; x++) {
			const double u = (x + 0.5 - 160) / 40, v = (y + 0.5 - 120) / 40, r = hypot(u, v), in = 0.98 * (1 - u * u / 5.8) - fabs(v);
			const double *of = in < -0.06 ? skin : in < 0 ? edge : r < 1.0 / 3 ? pupil : r < 1 ? iris : white;
			const double shade = (in > 0 ? 0.75 + 0.25 * fmin(in * 3, 1) : 1) * (1 + 0.02 * rng_normal(&rng)) * (r < 1 && r > 0.88 && in > 0 ? 0.8 : 1);
			double rgb[3];
			for (int c = 0; c < 3; c++)
				rgb[c] = shade * of[c];
			put(&photo, x, y, rgb);
		}
	return photo;
}

static void test_files(void **state)
{
	(void)state;
	struct evidence_net *net;
	struct err err = { 0 };
	assert_false(evidence_open(&net, scratch_path("none.onnx"), &err));
	ERR_HAS(err, "none.onnx");
	evidence_close(net);
	char *data;
	size_t size;
	err = (struct err){ 0 };
	assert_true(file_read(&data, &size, net_path, 1 << 22, &err));
	assert_true(size < 2000000);
	struct rng rng = { 7 };
	for (int i = 0; i < 40; i++) {
		const size_t cut = i < 8 ? (size_t)i * size / 8 : size, at = (size_t)rng_below(&rng, (int)size);
		data[at] ^= (char)(1 << rng_below(&rng, 8));
		const char *path = scratch_write("damaged.onnx", data, cut);
		err = (struct err){ 0 };
		assert_false(evidence_open(&net, path, &err));
		assert_null(net);
		ERR_HAS(err, "damaged");
		assert_null(strchr(err.msg, '\n'));
	}
	free(data);
}

static void check_planes(const struct evidence *e)
{
	for (long i = 0; i < (long)e->width * e->height; i++) {
		double sum = 0;
		for (int c = 0; c < EVIDENCE_CLASSES; c++) {
			assert_true(e->plane[c][i] >= 0);
			sum += e->plane[c][i];
		}
		NEAR(sum, 1, 1e-5);  // six rounded floats
	}
}

static void test_shapes(void **state)
{
	(void)state;
	struct evidence_net *net = open_net();
	struct err err = { 0 };
	static const int sizes[][2] = { { 320, 240 }, { 240, 320 }, { 1000, 90 }, { 40, 33 }, { 1, 1 } };
	for (int i = 0; i < COUNT(sizes); i++) {
		struct photo photo = blank(sizes[i][0], sizes[i][1]);
		struct evidence e;
		assert_true(evidence_whole(&e, net, &photo, 256, &err));
		check_planes(&e);
		// The photograph lies inside of the planes.
		assert_true(e.x0 <= 1e-9 && e.x0 + e.scale * e.width >= photo.width - 1e-9);
		assert_true(e.y0 <= 1e-9 && e.y0 + e.scale * e.height >= photo.height - 1e-9);
		evidence_free(&e);
		assert_true(evidence_window(&e, net, &photo, 20, 10, 20, &err));
		assert_int_equal(e.width, 128);
		assert_int_equal(e.height, 80);
		NEAR(e.scale, 1, 1e-12);
		NEAR(e.x0, 20 - 64, 1e-12);
		check_planes(&e);
		evidence_free(&e);
		struct evidence_region region[EVIDENCE_REGIONS];
		int n;
		assert_true(evidence_find(region, &n, net, &photo, &err));
		photo_free(&photo);
	}
	evidence_close(net);
}

static void test_plain_eye(void **state)
{
	(void)state;
	struct evidence_net *net = open_net();
	struct err err = { 0 };
	struct photo photo = plain_eye();
	struct evidence_region region[EVIDENCE_REGIONS];
	int n;
	assert_true(evidence_find(region, &n, net, &photo, &err));
	assert_true(n > 0);
	NEAR(region[0].x, 160, 6);  // a pixel of the planes is 2.5 px
	NEAR(region[0].y, 120, 6);
	NEAR(region[0].radius, 40, 8);
	struct evidence e;
	assert_true(evidence_window(&e, net, &photo, region[0].x, region[0].y, 40, &err));
	static const struct { double x, y; enum evidence_class class; } at[] = {
		{ 160, 120, EVIDENCE_PUPIL }, { 135, 125, EVIDENCE_IRIS }, { 186, 122, EVIDENCE_IRIS }, { 160, 145, EVIDENCE_IRIS },
		{ 105, 121, EVIDENCE_SCLERA }, { 214, 121, EVIDENCE_SCLERA }, { 160, 60, EVIDENCE_SKIN }, { 160, 185, EVIDENCE_SKIN },
	};
	for (int i = 0; i < COUNT(at); i++)
		if (!(evidence_at(&e, at[i].class, at[i].x, at[i].y) > 0.5F))
			fail_msg("class %d at (%g, %g) has %g", at[i].class, at[i].x, at[i].y, evidence_at(&e, at[i].class, at[i].x, at[i].y));
	evidence_free(&e);
	photo_free(&photo);
	evidence_close(net);
}

static struct photo drawn_photo(uint64_t number, bool mirrored)
{
	struct drawn d = drawn_make(number, true, 256, 192);
	struct photo photo = blank(256, 192);
	for (int y = 0; y < 192; y++)
		for (int x = 0; x < 256; x++)
			for (int c = 0; c < 3; c++)
				photo.rgb[3 * (y * 256 + x) + c] = (uint16_t)(257 * d.rgb[3 * (y * 256 + (mirrored ? 255 - x : x)) + c]);
	drawn_free(&d);
	return photo;
}

/* A window round a place and the window round the same place of the mirrored photograph. */
static void test_mirrored(void **state)
{
	(void)state;
	struct evidence_net *net = open_net();
	struct err err = { 0 };
	for (uint64_t number = 0; number < 6; number++) {
		struct evidence e[2];
		for (int m = 0; m < 2; m++) {
			struct photo photo = drawn_photo(number, m);
			assert_true(evidence_window(&e[m], net, &photo, m ? 256 - 100 : 100, 90, 30, &err));
			photo_free(&photo);
		}
		for (int c = 0; c < EVIDENCE_CLASSES; c++)
			for (int y = 0; y < e[0].height; y++)
				for (int x = 0; x < e[0].width; x++)
					NEAR(e[1].plane[c][y * e[1].width + e[1].width - 1 - x], e[0].plane[c][y * e[0].width + x], 2e-3);  // rounding, through the network
		for (int m = 0; m < 2; m++)
			evidence_free(&e[m]);
	}
	evidence_close(net);
}

static void test_threads(void **state)
{
	(void)state;
	struct evidence_net *net = open_net();
	struct err err = { 0 };
	struct photo photo = drawn_photo(5, false);
	struct evidence e[2];
	for (int t = 0; t < 2; t++) {
		omp_set_num_threads(1 + t);
		assert_true(evidence_window(&e[t], net, &photo, 128, 96, 30, &err));
	}
	assert_memory_equal(e[0].plane[0], e[1].plane[0], sizeof(float) * (size_t)e[0].width * (size_t)e[0].height * EVIDENCE_CLASSES);
	for (int t = 0; t < 2; t++)
		evidence_free(&e[t]);
	photo_free(&photo);
	evidence_close(net);
}

/* Threads that ask at once, at two sizes, each get what one by itself gets. */
static void test_at_once(void **state)
{
	(void)state;
	enum { N = 12 };
	struct evidence_net *net = open_net();
	struct photo photo = plain_eye();
	struct evidence alone[2], e[N] = { 0 };
	struct err err = { 0 }, errs[N] = { 0 };
	for (int i = 0; i < 2; i++)
		assert_true(evidence_whole(&alone[i], net, &photo, i ? 256 : 128, &err));
	bool ok[N];
#pragma omp parallel for schedule(dynamic, 1) num_threads(4)
	for (int i = 0; i < N; i++)
		ok[i] = evidence_whole(&e[i], net, &photo, i % 2 ? 256 : 128, &errs[i]);
	for (int i = 0; i < N; i++) {
		const struct evidence *want = &alone[i % 2];
		assert_true(ok[i] && e[i].width == want->width && e[i].height == want->height);
		assert_memory_equal(e[i].plane[0], want->plane[0], sizeof(float) * EVIDENCE_CLASSES * (size_t)(want->width * want->height));
		evidence_free(&e[i]);
	}
	for (int i = 0; i < 2; i++)
		evidence_free(&alone[i]);
	photo_free(&photo);
	evidence_close(net);
}

int main(void)
{
	const struct CMUnitTest tests[] = { SCRATCH_TEST(test_files), cmocka_unit_test(test_shapes), cmocka_unit_test(test_plain_eye),
		                            cmocka_unit_test(test_mirrored), cmocka_unit_test(test_threads), cmocka_unit_test(test_at_once) };
	return cmocka_run_group_tests(tests, 0, 0);
}
