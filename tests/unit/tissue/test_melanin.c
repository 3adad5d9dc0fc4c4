/* Melanin that differs over an iris: a brown ring about the pupil and a darker side come back from a texture painted with them, within their
 * sigmas; an iris of one melanin gets no map; the map survives its file; a damaged one is refused. */
#include "base/json.h"
#include "base/mem.h"
#include "math/rng.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"
#include "tissue/pigment/melanin_file.h"

enum { SIZE = 320, LIGHT = 8, LEVELS = 24 };
static const double extent = 6.4, root = 6;
static const struct pupil pupil = { 0, 0, 2 };
static const double white[3] = { 1, 1, 1 };
static const double truth[PIGMENT_N] = { -3, 0.7, -5, 0.7, -1, 0, 0, 0, 0 };
static const struct pigment_classes_conf classes_conf = { .rings = 4, .levels = 5, .inner = 0.12, .outer = 0.85, .grain = 0.1 };
static const struct melanin_conf map_conf = { .field = 0.5, .reach = 0.8, .cell = 0.5 };

/* Melanin over that of the iris, ln: from `rings` at the pupil to its negative at the root, and `side` on the right. */
static double melanin_of(double x, double y, double rings, double side)
{
	return rings * (1 - 2 * fmin(fmax(iris_share(&pupil, root, x, y), 0), 1)) + side * fmin(fmax(x / 4, -1), 1);
}

static struct pigment_conf known(void)
{
	struct pigment_conf c = { .abl_thickness = 0.04, .cos_light = 0.84, .cos_view = 1, .light_error = 0.05, .model_error = 0.02, .floor = 1e-4,
		                      .profile_error = 0.1, .ring_error = 0.05, .prior_spread = { log(0.12), 0.6 }, .bands = 4, .starts = 1, .multiple = true,
		                      .melanin_ring = 0.7 };
	const double sigma[PIGMENT_N] = { 1.5, 0.02, 0.1, 0.02, 0.05, 0.01, 1e-3, 1e-3, 1e-3 };
	for (int j = 0; j < PIGMENT_N; j++) {
		c.prior[j][0] = truth[j];
		c.prior[j][1] = sigma[j];
	}
	return c;
}

struct eye_maps {
	struct image clean, thickness, light;
	struct pigment_texture texture;
};

/* A texture by the model, with noise in every texel as large as the model's own error. */
static void paint(struct eye_maps *m, const struct pigment_conf *conf, double rings, double side, uint64_t seed)
{
	struct tissue_optics optics[LEVELS];
	struct tissue_bands bands;
	struct rng rng = { seed };
	tissue_bands_make(&bands, conf->bands, conf->illuminant);
	for (int l = 0; l < LEVELS; l++) {
		struct tissue tissue = pigment_tissue_beyond(truth, -2.3 + 0.2 * l, conf);
		tissue_optics_make(&optics[l], &tissue, &bands);
	}
	*m = (struct eye_maps){ .clean = image_new(SIZE, SIZE, 4), .thickness = image_new(SIZE, SIZE, 1), .light = image_new(LIGHT, LIGHT, 4) };
	for (int i = 0; i < 4 * LIGHT * LIGHT; i++)
		m->light.px[i] = 1;
	for (int i = 0; i < SIZE * SIZE; i++) {
		double x = (2 * (i % SIZE + 0.5) / SIZE - 1) * extent, y = (2 * (i / SIZE + 0.5) / SIZE - 1) * extent, rgb[3];
		double ln = melanin_of(x, y, rings, side);
		float *p = m->clean.px + 4 * i;
		m->thickness.px[i] = 0.45f;
		pigment_model(rgb, truth, &optics[(int)fmin(fmax(lround((ln + 2.3) / 0.2), 0), LEVELS - 1)], 0.45, conf);
		for (int k = 0; k < 3; k++)
			p[k] = (float)(rgb[k] * exp(conf->model_error * rng_normal(&rng)));
		p[3] = 1;
	}
	m->texture = (struct pigment_texture){ &m->clean, &m->thickness, &m->light, extent, &pupil, root, white };
}

static void maps_free(struct eye_maps *m)
{
	image_free(&m->clean);
	image_free(&m->thickness);
	image_free(&m->light);
}

static void fit(struct melanin_map *map, struct pigment_fit *out, double rings, double side)
{
	struct pigment_conf conf = known();
	struct pigment_classes classes;
	struct eye_maps m;
	struct err err = { 0 };
	paint(&m, &conf, rings, side, 5);
	assert_true(pigment_classify(&classes, &m.texture, &classes_conf, &err));
	assert_true(pigment_solve(out, &classes, &conf, 0, &err));
	assert_true(melanin_fit(map, &m.texture, out, &conf, &classes_conf, &map_conf, &err));
	maps_free(&m);
}

/* The rings differ by what they were painted with, and so do the sides; at the nodes that were seen, the sigmas hold the truth. */
static void test_differs(void **state)
{
	struct melanin_map *map = mem_new(1, sizeof *map);
	struct pigment_fit out;
	int seen = 0, inside = 0;
	double worst = 0;
	(void)state;
	fit(map, &out, 0.8, 0.5);
	assert_true(out.varies > 0.5 && map->n > 0);
	for (int r = 1; r < out.rings; r++) {
		double want = 1.6 * (out.ring[r - 1].share - out.ring[r].share), got = out.ring[r].melanin - out.ring[r - 1].melanin;
		assert_true(fabs(got - want) < 0.15);
	}
	for (int i = 0; i < map->n * map->n; i++) {
		double x = (2 * (i % map->n + 0.5) / map->n - 1) * extent, y = (2 * (i / map->n + 0.5) / map->n - 1) * extent;
		double share = iris_share(&pupil, root, x, y), got = out.x[PIGMENT_ABL_MELANIN] + map->ln[i];
		double off = fabs(got - truth[PIGMENT_ABL_MELANIN] - melanin_of(x, y, 0.8, 0.5));
		if (share < 0.2 || share > 0.8)
			continue;
		seen++;
		inside += off < 2 * hypot(map->sigma[i], out.sigma[PIGMENT_ABL_MELANIN]);
		worst = fmax(worst, off);
	}
	print_message("within two sigma: %d of %d nodes; the worst is off by %.2f\n", inside, seen, worst);
	assert_true(seen > 100 && inside > 0.9 * seen);
	assert_true(worst < 0.4);  // painted in steps of 0.2
	free(map);
}

/* Where one melanin explains the colours there is no map, and the fit is that of one. */
static void test_same(void **state)
{
	struct melanin_map *map = mem_new(1, sizeof *map);
	struct pigment_fit out;
	(void)state;
	fit(map, &out, 0, 0);
	assert_true(out.varies == 0 && map->n == 0);
	for (int r = 0; r < out.rings; r++)
		assert_true(out.ring[r].melanin == 0);
	assert_true(fabs(out.x[PIGMENT_ABL_MELANIN] - truth[PIGMENT_ABL_MELANIN]) < 0.15);
	free(map);
}

static void test_file(void **state)
{
	struct melanin_map *map = mem_new(1, sizeof *map), *back = mem_new(1, sizeof *back);
	struct pigment_fit out = { .rings = 1 };
	struct err err = { 0 };
	(void)state;
	*map = (struct melanin_map){ .n = 3, .extent = 6 };
	for (int i = 0; i < 9; i++) {
		map->ln[i] = 0.25 * i - 1;
		map->sigma[i] = 0.5;
	}
	json_t *root_json = json_object();
	json_object_set_new(root_json, "melanin_map", melanin_json(map, &out));
	assert_true(json_write(scratch_path("map.json"), root_json, 0, &err));
	assert_true(melanin_load(back, scratch_path("map.json"), &err));
	assert_true(back->n == 3 && back->extent == 6);
	for (int i = 0; i < 9; i++)
		assert_true(fabs(back->ln[i] - map->ln[i]) < 1e-3);
	assert_true(fabs(melanin_at(back, 0, 0) - map->ln[4]) < 1e-9 && fabs(melanin_at(back, 2, 0) - (map->ln[4] + map->ln[5]) / 2) < 1e-9);
	json_decref(root_json);
	scratch_text("none.json", "{}");
	assert_true(melanin_load(back, scratch_path("none.json"), &err) && back->n == 0);
	static const char *const bad[] = { "{\"melanin_map\": {\"n\": 1, \"extent_mm\": 6, \"ln\": [0], \"sigma\": [0]}}",
		                               "{\"melanin_map\": {\"n\": 2, \"extent_mm\": 6, \"ln\": [0, 0, 0], \"sigma\": [0, 0, 0, 0]}}",
		                               "{\"melanin_map\": {\"n\": 2, \"extent_mm\": 6, \"ln\": [0, 0, 0, 99], \"sigma\": [0, 0, 0, 0]}}",
		                               "{\"melanin_map\": {\"n\": 1e9, \"extent_mm\": 6, \"ln\": [], \"sigma\": []}}",
		                               "{\"melanin_map\": 7}" };
	for (int i = 0; i < COUNT(bad); i++) {
		err = (struct err){ 0 };
		scratch_text("bad.json", bad[i]);
		assert_true(!melanin_load(back, scratch_path("bad.json"), &err) && err_is(&err));
	}
	free(map);
	free(back);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_differs), cmocka_unit_test(test_same), SCRATCH_TEST(test_file),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
