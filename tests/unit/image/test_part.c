/* Parts of photographs at another scale: a ramp keeps its values, borders repeat, a reduced photograph holds the means of squares. */
#include <omp.h>

#include "base/mem.h"
#include "image/photo/part.h"
#include "tests/lib/unit.h"

enum { W = 90, H = 70 };

/* Red 300 x + 100 y, green the same mirrored, blue constant; of the pixels' centres. */
static struct photo ramp(void)
{
	struct photo photo = { .width = W, .height = H, .bits = 16, .rgb = mem_array(3 * W * H, sizeof(uint16_t)) };
	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++) {
			uint16_t *to = photo.rgb + 3 * (y * W + x);
			to[0] = (uint16_t)(300 * x + 100 * y + 200);
			to[1] = (uint16_t)(300 * (W - 1 - x) + 100 * y + 200);
			to[2] = 12345;
		}
	return photo;
}

/* The mean of a linear function over a square is its value at the middle. Where a square ends within pixels, these are steps: at most an
 * eighth of a pixel's step at either end, over the square's side. */
static void a_ramp_keeps_its_values(void **state)
{
	(void)state;
	struct photo photo = ramp();
	static const struct { double x0, y0, scale; int width, height; } part[] = {
		{ 10, 10, 1, 20, 20 }, { 10.3, 9.6, 2.37, 16, 11 }, { 20, 30, 0.25, 40, 24 }, { 5, 5, 7, 5, 4 },
	};
	for (int k = 0; k < COUNT(part); k++) {
		const int n = part[k].width * part[k].height;
		const double off = k == 1 ? 400 / (8 * part[k].scale) : 0.1;  // floats of 65535: 0.004 each, some ten added
		float *px = photo_part(&photo, part[k].x0, part[k].y0, part[k].scale, part[k].width, part[k].height);
		for (int i = 0; i < n; i++) {
			const double x = part[k].x0 + (i % part[k].width + 0.5) * part[k].scale - 0.5, y = part[k].y0 + (i / part[k].width + 0.5) * part[k].scale - 0.5;
			NEAR(px[i] * 65535, 300 * x + 100 * y + 200, off);
			NEAR(px[n + i] * 65535, 300 * (W - 1 - x) + 100 * y + 200, off);
			NEAR(px[2 * n + i] * 65535, 12345, 0.1);
		}
		free(px);
	}
	photo_free(&photo);
}

static void borders_repeat(void **state)
{
	(void)state;
	struct photo photo = ramp();
	float *px = photo_part(&photo, -1000, -1000, 100, 20, 20);
	NEAR(px[0] * 65535, 200, 0.1);
	NEAR(px[19] * 65535, 300 * (W - 1) + 200, 0.1);
	NEAR(px[400 - 1] * 65535, 300 * (W - 1) + 100 * (H - 1) + 200, 0.1);
	free(px);
	photo_free(&photo);
}

static void reduced_by_squares(void **state)
{
	(void)state;
	struct photo photo = ramp();
	double scale;
	struct photo small = photo_reduced(&photo, W / 2, &scale);
	NEAR(scale, 2, 0);
	assert_int_equal(small.width, W / 2);
	assert_int_equal(small.height, H / 2);
	for (int y = 0; y < H / 2; y++)
		for (int x = 0; x < W / 2; x++) {
			const uint16_t *a = photo.rgb + 3 * (2 * y * W + 2 * x), *b = a + 3 * W, *got = small.rgb + 3 * (y * (W / 2) + x);
			for (int c = 0; c < 3; c++)
				NEAR(got[c], (a[c] + a[c + 3] + b[c] + b[c + 3]) / 4.0, 0.55);  // rounded
		}
	photo_free(&small);
	small = photo_reduced(&photo, 1000, &scale);
	NEAR(scale, 1, 0);
	assert_memory_equal(small.rgb, photo.rgb, 3 * W * H * sizeof *photo.rgb);
	photo_free(&small);
	photo_free(&photo);
}

static void threads_do_not_matter(void **state)
{
	(void)state;
	struct photo photo = ramp();
	float *px[2];
	for (int t = 0; t < 2; t++) {
		omp_set_num_threads(1 + 2 * t);
		px[t] = photo_part(&photo, 3.3, -2.1, 1.7, 50, 40);
	}
	assert_memory_equal(px[0], px[1], 3 * 50 * 40 * sizeof(float));
	free(px[0]);
	free(px[1]);
	photo_free(&photo);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_ramp_keeps_its_values),
		cmocka_unit_test(borders_repeat),
		cmocka_unit_test(reduced_by_squares),
		cmocka_unit_test(threads_do_not_matter),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
