/* Morph targets as whole steps: what a reader of the file gets back, and what is not in it. */
#include <jansson.h>

#include "math/rng.h"
#include "rig/glb/targets.h"
#include "tests/lib/unit.h"

enum { N = 400 };

static double number(const json_t *of, const char *key)
{
	return json_number_value(json_object_get(of, key));
}

/* What a sparse accessor of vectors of three stands for, over its unit, by the glTF specification: out[N][3]. Returns how many rows it has. */
static int read_back(double (*out)[3], const struct glb_buffer *g, int accessor)
{
	const json_t *a = json_array_get(g->accessors, (size_t)accessor), *sparse = json_object_get(a, "sparse"), *indices = json_object_get(sparse, "indices");
	const json_t *values = json_object_get(sparse, "values");
	const int few = (int)number(sparse, "count"), type = (int)number(a, "componentType");
	const char *row = g->bin + (long)number(json_array_get(g->views, (size_t)number(indices, "bufferView")), "byteOffset");
	const char *x = g->bin + (long)number(json_array_get(g->views, (size_t)number(values, "bufferView")), "byteOffset");
	memset(out, 0, N * sizeof *out);
	assert_int_equal(number(indices, "componentType"), GLB_USHORT);
	for (int i = 0; i < few; i++) {
		uint16_t at;
		memcpy(&at, row + 2 * i, sizeof at);
		assert_true(at < N);
		for (int c = 0; c < 3; c++) {
			int16_t half = 0;
			float whole = 0;
			memcpy(&half, x + 2 * (3 * i + c), type == GLB_SHORT ? sizeof half : 0);
			memcpy(&whole, x + 4 * (3 * i + c), type == GLB_FLOAT ? sizeof whole : 0);
			out[at][c] = type == GLB_SHORT ? fmax(half / 32767.0, -1) : type == GLB_BYTE ? fmax((int8_t)x[3 * i + c] / 127.0, -1) : (double)whole;
		}
	}
	return few;
}

static struct glb_buffer buffer_new(void)
{
	return (struct glb_buffer){ .views = json_array(), .accessors = json_array() };
}

static void buffer_free(struct glb_buffer *g)
{
	json_decref(g->views);
	json_decref(g->accessors);
	free(g->bin);
}

/* Every second vertex moves, by up to `most` mm. */
static void moves(float *by, float *lean, double most, uint64_t seed)
{
	struct rng rng = { seed };
	for (int i = 0; i < 3 * N; i++) {
		by[i] = i / 3 % 2 ? (float)rng_range(&rng, -most, most) : 0;
		lean[i] = i / 3 % 2 ? (float)rng_range(&rng, -0.9, 0.9) : 0;
	}
}

static int accessor_of(const struct glb_targets *t, int target, const char *what)
{
	return (int)number(json_array_get(t->list, (size_t)target), what);
}

static void steps_are_fine(void **state)
{
	(void)state;
	static float by[3 * N], lean[3 * N];
	static double out[N][3];
	struct glb_buffer g = buffer_new();
	struct glb_targets t = glb_targets_new();
	const double unit = 30;  // a jaw that opens
	for (int k = 0; k < 3; k++) {
		moves(by, lean, k == 2 ? 45 : 12, (uint64_t)k + 1);  // the last goes further than the unit
		glb_targets_add(&t, &g, "moves", by, lean, N, unit, 0);
		assert_int_equal(read_back(out, &g, accessor_of(&t, k, "POSITION")), N / 2);
		for (int i = 0; i < 3 * N; i++)
			NEAR(unit * out[i / 3][i % 3], by[i], k == 2 ? 1e-5 : 0.0005);  // half a step is 0.46 um
		read_back(out, &g, accessor_of(&t, k, "NORMAL"));
		for (int i = 0; i < 3 * N; i++)
			NEAR(out[i / 3][i % 3], lean[i], 0.5 / 127 + 1e-6);
	}
	assert_int_equal(json_array_size(g.views), 1 + 3 * 2);  // the rows once
	glb_targets_free(&t);
	buffer_free(&g);
}

/* The range of an accessor of whole numbers is of those, as the specification has it; rows that are left out are zero. */
static void ranges_are_of_steps(void **state)
{
	(void)state;
	static float by[3 * N];
	struct glb_buffer g = buffer_new();
	struct glb_targets t = glb_targets_new();
	by[3 * 5] = 10;
	by[3 * 7] = 5;
	glb_targets_add(&t, &g, "one", by, 0, N, 10, 0);
	const json_t *a = json_array_get(g.accessors, (size_t)accessor_of(&t, 0, "POSITION"));
	assert_int_equal(json_integer_value(json_array_get(json_object_get(a, "max"), 0)), 32767);
	assert_int_equal(json_integer_value(json_array_get(json_object_get(a, "min"), 0)), 0);
	assert_int_equal(json_integer_value(json_object_get(json_object_get(a, "sparse"), "count")), 2);
	assert_null(json_object_get(json_array_get(t.list, 0), "NORMAL"));
	glb_targets_free(&t);
	buffer_free(&g);
}

static void what_does_not_move_takes_no_room(void **state)
{
	(void)state;
	static float by[3 * N], lean[3 * N];
	struct glb_buffer g = buffer_new();
	struct glb_targets t = glb_targets_new();
	by[4] = 1e-5f;  // less than half a step
	lean[4] = 1e-3f;
	glb_targets_add(&t, &g, "still", by, lean, N, 10, 0);
	assert_int_equal(g.size, 0);
	assert_null(json_object_get(json_array_get(g.accessors, 0), "sparse"));
	json_t *mesh = json_pack("{s:[{}]}", "primitives");
	assert_int_equal(glb_targets_put(&t, mesh, &(struct glb_bake){ 0 }), 1);
	assert_int_equal(json_array_size(json_object_get(mesh, "weights")), 1);
	json_decref(mesh);
	glb_targets_free(&t);
	buffer_free(&g);
}

static void the_unit_holds_all_targets(void **state)
{
	(void)state;
	float skin[3] = { 1, -7, 2 }, pose[3] = { 3, 0, 0 }, hair[3] = { 0, 0, 9 };
	struct glb_bake b = { .n = 1, .n_targets = 1, .target = skin, .n_poses = 1, .pose = pose };
	NEAR(glb_unit(&b, 0), 7, 1e-6);
	b.n_hair = 1;
	b.hair_target = b.hair_pose = hair;
	NEAR(glb_unit(&b, 0), 9, 1e-6);
	hair[0] = 4000;
	NEAR(glb_unit(&b, 0), 500, 1e-6);
	NEAR(glb_unit(&(struct glb_bake){ 0 }, 0), 1000, 1e-6);
}

/* Small targets take a byte an axis: with all weights at 1, no vertex is further off than stated; the largest ones stay as they are. */
static void small_ones_are_bytes(void **state)
{
	(void)state;
	enum { K = 6 };
	static float by[K][3 * N], none[3 * N];
	static double out[N][3], off[N][3];
	static const double size[K] = { 14, 0.9, 0.4, 1.5, 0.02, 3 };
	double most[K] = { 0 }, gain[K], unit = 14, worst = 0;
	struct glb_buffer g = buffer_new();
	struct glb_targets t = glb_targets_new();
	int bytes = 0;
	for (int k = 0; k < K; k++) {
		moves(by[k], none, size[k], (uint64_t)k + 9);
		for (int i = 0; i < 3 * N; i++)
			most[k] = fmax(most[k], fabs((double)by[k][i]));
	}
	glb_targets_small(gain, most, K, unit);
	for (int k = 0; k < K; k++) {
		glb_targets_add(&t, &g, "moves", by[k], 0, N, unit, gain[k]);
		read_back(out, &g, accessor_of(&t, k, "POSITION"));
		for (int i = 0; i < 3 * N; i++)
			off[i / 3][i % 3] += fabs(unit * out[i / 3][i % 3] / fmax(gain[k], 1) - (double)by[k][i]);
		bytes += gain[k] > 0;
	}
	for (int i = 0; i < N; i++)
		worst = fmax(worst, sqrt(off[i][0] * off[i][0] + off[i][1] * off[i][1] + off[i][2] * off[i][2]));
	print_message("%d of %d targets of 8 bits: %.4f mm off\n", bytes, K, worst);
	assert_true(bytes == 4 && gain[0] == 0 && gain[5] == 0 && worst < 0.031 && worst > 0.003);
	glb_targets_free(&t);
	buffer_free(&g);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(steps_are_fine),
		cmocka_unit_test(ranges_are_of_steps),
		cmocka_unit_test(what_does_not_move_takes_no_room),
		cmocka_unit_test(the_unit_holds_all_targets),
		cmocka_unit_test(small_ones_are_bytes),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
