/* Edges and hairs of a portrait, against the same picture drawn four times as large and averaged; what sky is left beside a wall. */
#include "draw/face/impl.h"
#include "draw/face/sky.h"
#include "rig/drive.h"
#include "tests/lib/scenes/portrayed.h"
#include "tests/lib/unit.h"

enum { WIDTH = 240, HEIGHT = 100, FINER = 4 };

static int setup(void **state)
{
	struct portrayed *m = calloc(1, sizeof *m);
	*state = m;
	return portrayed_make(m, 0) ? 0 : 1;
}

static int teardown(void **state)
{
	portrayed_free(*state);
	free(*state);
	return 0;
}

/* The left eye from a little below, so that the upper lid's rim hides some of what is behind it. */
static struct image draw(struct portrayed *m, double lash_mm, int samples, int finer, unsigned char *kind)
{
	const struct scene *eyes[2] = { &m->eye, &m->eye };
	struct portrait_conf conf = { .lights = 64, .subdivide = 1, .samples = samples, .eye_samples = 1, .skin_rgb = { 0.5, 0.4, 0.3 }, .scatter_mm = 0.2, .hair = { .lash_mm = lash_mm, .lashes = 95, .margin_mm = 1.1 }, .hair_rgb = { 0.022, 0.014, 0.010 } };
	struct portrait *p = portrait_new(&m->rig, eyes, &m->env, &conf);
	double c[12];
	drive_look(c, &m->rig, 0, 0, 1);
	portrait_pose(p, c);
	struct portrait_view view = portrait_front(&m->rig, 0, 48, 0.15, -0.2, WIDTH * finer, HEIGHT * finer);
	portrait_light(p, &view, true);
	struct image out = portrait_draw(p, &view);
	// 1: one edge of skin before another in the pixel, by the depths of three samples in a row; 2: a hair in it.
	struct portrait_spot *spots = portrait_raster(p, &view, samples);
	struct portrait_veils veils = portrait_veils_of(p, &view, spots, samples);
	for (int i = 0; kind && i < WIDTH * HEIGHT; i++)
		for (int k = 0; k < samples * samples; k++) {
			long row = (long)samples * WIDTH, at = (i / WIDTH * samples + k / samples) * row + i % WIDTH * samples + k % samples;
			const struct portrait_spot *o = &spots[at];
			if (veils.at[i] >= 0)
				kind[i] = 2;
			else if (kind[i] != 2 && k % samples + 2 < samples && o[0].face >= 0 && o[1].face >= 0 && o[2].face >= 0
			         && fabsf(o[0].depth - 2 * o[1].depth + o[2].depth) > 0.2f)
				kind[i] = 1;
		}
	portrait_veils_free(&veils);
	free(spots);
	portrait_free(p);
	return out;
}

/* The large picture's mean over a pixel of the small one; by a tent as wide as two, for hairs. */
static void mean_at(double rgb[3], const struct image *large, int x, int y, bool tent)
{
	double all = 0;
	rgb[0] = rgb[1] = rgb[2] = 0;
	for (int v = FINER * (y - tent); v < FINER * (y + 1 + tent); v++)
		for (int u = FINER * (x - tent); u < FINER * (x + 1 + tent); u++) {
			double du = fabs((u + 0.5) / FINER - x - 0.5), dv = fabs((v + 0.5) / FINER - y - 0.5), w = tent ? fmax(1 - du, 0) * fmax(1 - dv, 0) : 1;
			all += w;
			for (int c = 0; c < 3; c++)
				rgb[c] += w * (double)fminf(image_at(large, u, v)[c], 1.5f);
		}
	for (int c = 0; c < 3; c++)
		rgb[c] /= all;
}

/* Root mean square difference from the large picture over the pixels of a kind; how many of them: more than 100. */
static double off(struct portrayed *m, double lash_mm, int kind, double *step)
{
	unsigned char *kinds = calloc(WIDTH * HEIGHT, 1);
	struct image small = draw(m, lash_mm, 3, 1, kinds), large = draw(m, lash_mm, 3, FINER, 0);
	double sum = 0, steps = 0;
	int n = 0;
	for (int y = 1; y + 1 < HEIGHT; y++)
		for (int x = 1; x + 1 < WIDTH; x++) {
			double want[3];
			if (kinds[y * WIDTH + x] != kind)
				continue;
			mean_at(want, &large, x, y, kind == 2);
			for (int c = 0; c < 3; c++)
				sum += pow((double)image_at(&small, x, y)[c] - want[c], 2);
			steps += pow((double)image_at(&large, FINER * x, FINER * y)[1] - (double)image_at(&large, FINER * x + FINER - 1, FINER * y + FINER - 1)[1], 2);
			n++;
		}
	free(kinds);
	image_free(&small);
	image_free(&large);
	printf("%d pixels; ", n);
	assert_true(n > 20);
	*step = sqrt(steps / n);
	return sqrt(sum / n / 3);
}

static void edges_are_averaged(void **state)
{
	double step, d = off(*state, 0, 1, &step);
	printf("edges of skin: off by %.4f rms of the same drawn four times as large, where colours step by %.3f\n", d, step);
	assert_true(step > 0.03);
	assert_true(d < 0.0012);  // of samples that share one pixel's light: 0.0018
}

static void hairs_are_averaged(void **state)
{
	double step, d = off(*state, 9, 2, &step);
	printf("hairs: off by %.4f rms, where colours step by %.3f\n", d, step);
	assert_true(step > 0.05);
	assert_true(d < 0.01);  // of a box as wide as a pixel: 0.013
}

/* A wall that hides half of the sky: of directions weighted by the cosine half are left, whose mean is (4 / (3 pi), 0, 2 / 3); whichever way it stands. */
static void half_a_sky_lies_beside_the_wall(void **state)
{
	(void)state;
	static const float wall[4][3] = { { 0, 0, -900 }, { 0, 0, 900 }, { 900, 0, 900 }, { 900, 0, -900 } };
	static const int32_t faces[2][3] = { { 0, 1, 2 }, { 0, 2, 3 } };
	for (int turn = 0; turn < 12; turn++) {
		const float a = (float)(turn * M_PI / 6), along[3] = { cosf(a), 0, -sinf(a) }, normal[3] = { sinf(a) * 0.6f, 0.8f, cosf(a) * 0.6f };
		const float off[3] = { normal[1] * along[2] - normal[2] * along[1], normal[2] * along[0] - normal[0] * along[2], normal[0] * along[1] - normal[1] * along[0] };
		float corner[4][3], middle[3], at[3] = { 0 }, beside = 0, above = 0, aside = 0;
		for (int k = 0; k < 4; k++)
			for (int c = 0; c < 3; c++)
				corner[k][c] = 0.03f * along[c] + wall[k][2] * off[c] + wall[k][0] * normal[c];
		struct portrait p = { .shadow = ray_scene_new(4, (const float(*)[3])corner, 2, faces) };
		const float open = portrait_sky_over(middle, &p, at, normal);
		for (int c = 0; c < 3; c++) {
			beside -= middle[c] * along[c];
			above += middle[c] * normal[c];
			aside += middle[c] * off[c];
		}
		NEAR(open, 0.5, 0.051);  // of twenty directions
		NEAR(atan2f(beside, above), atan(4 / (3 * M_PI) / (2 / 3.0)), 0.1);
		NEAR(aside, 0, 0.15);
		ray_scene_free(p.shadow);
		p.shadow = ray_scene_new(0, 0, 0, 0);
		NEAR(portrait_sky_over(middle, &p, at, normal), 1, 0);
		NEAR(middle[0] * normal[0] + middle[1] * normal[1] + middle[2] * normal[2], 1, 0.01);
		ray_scene_free(p.shadow);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(edges_are_averaged),
		cmocka_unit_test(hairs_are_averaged),
		cmocka_unit_test(half_a_sky_lies_beside_the_wall),
	};
	return cmocka_run_group_tests(tests, setup, teardown);
}
