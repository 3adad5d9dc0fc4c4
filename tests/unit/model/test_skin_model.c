/* The model of lids and skin: closed forms through its matrices, folding, files. */
#include "base/file.h"
#include "base/mem.h"
#include "math/rng.h"
#include "model/model.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

static void fill(double *x, int n, struct rng *rng)
{
	for (int i = 0; i < n; i++)
		x[i] = rng_normal(rng);
}

static struct skin_model random_model(uint64_t seed)
{
	struct rng rng = { seed };
	struct skin_model m = { .n_au = 2, .n_points = 5, .n_vertices = 7, .n_lid_pc = 6, .n_skin_pc = 4 };
	skin_model_alloc(&m);
	fill(m.l0, m.n_lid, &rng);
	fill(m.K, m.n_lid * m.n_lid_pc, &rng);
	fill(m.L, m.n_lid_pc * (SKIN_EYE_INPUTS + 1), &rng);
	fill(m.u0, 2 * m.n_vertices, &rng);
	fill(m.J, 2 * m.n_vertices * m.n_skin_pc, &rng);
	fill(m.M, m.n_skin_pc * (m.n_lid + m.n_au + 1), &rng);
	fill(m.low, m.n_inputs, &rng);
	fill(m.skin_reach, m.n_inputs * (m.n_inputs + 1), &rng);
	fill(m.rest_e, m.n_skin_pc, &rng);
	fill(&m.baseline[0][0][0], 12, &rng);
	known_of(&m.known, 3, m.skin_reach, m.n_inputs, 0.25);
	for (int i = 0; i < m.n_vertices; i++)
		m.vertices[i] = 3 * i;
	for (int i = 3; i < SKIN_EYE_INPUTS; i += i == 4 ? 4 : 1) {
		m.closed[i] = rng_normal(&rng);
		m.open[i] = m.closed[i] + 20 + rng_normal(&rng);
	}
	m.au_names[0] = mem_str("smile");
	m.au_names[1] = mem_str("frown");
	m.camera = (struct skin_camera){ 1280, 720, 6000, { 640, 360 }, { 0 }, { { 1 }, { 0, 1 }, { 0, 0, 1 }, { 0, 0, 0, 1 } } };
	return m;
}

static void aperture(void **state)
{
	(void)state;
	struct skin_model m = random_model(1);
	double c[12], g[12], back[12];
	for (int i = 0; i < 12; i++)
		c[i] = 0.1 * i;
	skin_model_inputs(g, &m, c);
	skin_model_controls(back, &m, g);
	for (int i = 0; i < 12; i++)
		NEAR(back[i], c[i], 1e-14);
	c[3] = 0;
	c[9] = 1;
	skin_model_inputs(g, &m, c);
	assert_true(g[3] == m.closed[3] && g[0] == c[0] && g[11] == c[11]);
	NEAR(g[9], m.open[9], 1e-13);
	skin_model_free(&m);
}

/* Equations 3.8 to 3.10 in all generality: folding changes nothing but rounding. */
static void folded(void **state)
{
	(void)state;
	for (uint64_t seed = 1; seed <= 20; seed++) {
		struct skin_model m = random_model(seed);
		struct rng rng = { seed + 1000 };
		double W[4 * 13], c[12], u[14];
		if (seed % 2)  // an eye that was not seen
			for (int i = m.n_lid / 2; i < m.n_lid; i++) {
				m.l0[i] = NAN;
				memset(m.K + i * m.n_lid_pc, 0, (size_t)m.n_lid_pc * sizeof(double));
				for (int r = 0; r < m.n_skin_pc; r++)
					m.M[r * (m.n_lid + m.n_au + 1) + i] = 0;
			}
		skin_model_fold(W, &m);
		fill(c, 12, &rng);
		skin_model_predict(u, 0, &m, c);
		for (int i = 0; i < 14; i++) {
			double sum = m.u0[i];
			for (int r = 0; r < 4; r++) {
				double e = W[13 * r + 12];
				for (int k = 0; k < 12; k++)
					e += W[13 * r + k] * c[k];
				sum += m.J[4 * i + r] * e;
			}
			NEAR(sum, u[i], 1e-11 * (1 + fabs(u[i])) * 100);  // sums of 12 * 6 * 40 terms of size 20
		}
		skin_model_free(&m);
	}
}

static void baseline(void **state)
{
	(void)state;
	struct skin_model m = random_model(3);
	double a[2], b[2], far[2], gaze[3] = { 50, -40, 0 };
	known_of(&m.known, 3, (double[33]){ [5] = -20, [6] = -10, [16] = 20, [17] = -10, [27] = 0, [28] = 10 }, 11, 0.25);
	skin_model_baseline(a, &m, 1, 1, 3, -5);
	skin_model_baseline(b, &m, 1, 0.5, 3, -5);
	NEAR(a[0], 3 * m.baseline[1][0][0] - 5 * m.baseline[1][0][1] + m.baseline[1][0][2], 1e-14);
	NEAR(b[1], a[1] / 2, 1e-14);
	skin_model_baseline(far, &m, 1, 1, gaze[0], gaze[1]);
	known_hold(gaze, &m.known, 1);
	skin_model_baseline(b, &m, 1, 1, 20, -10);
	NEAR(far[0], gaze[0] * m.baseline[1][0][0] + gaze[1] * m.baseline[1][0][1] + m.baseline[1][0][2], 1e-14);
	assert_true(hypot(gaze[0] - 20, gaze[1] + 10) < 0.25 * 20 && fabs(far[0] - b[0]) > 1e-3);
	skin_model_free(&m);
}

static void files(void **state)
{
	(void)state;
	struct skin_model m = random_model(5), r;
	struct err err = { 0 };
	m.l0[3] = NAN;
	assert_true(skin_model_save(&m, scratch_path("skin"), "{\"stage\":\"train\"}", &err));
	assert_true(skin_model_load(&r, scratch_path("skin"), &err));
	assert_memory_equal(r.K, m.K, (size_t)(m.n_lid * m.n_lid_pc) * sizeof(double));
	assert_memory_equal(r.M, m.M, (size_t)(m.n_skin_pc * (m.n_lid + m.n_au + 1)) * sizeof(double));
	assert_memory_equal(r.skin_reach, m.skin_reach, (size_t)(m.n_inputs * (m.n_inputs + 1)) * sizeof(double));
	assert_true(isnan(r.l0[3]) && r.l0[4] == m.l0[4]);
	assert_string_equal(r.au_names[1], "frown");
	assert_int_equal(r.vertices[6], 18);
	NEAR(r.baseline[1][1][2], m.baseline[1][1][2], 1e-11);  // JSON keeps 12 digits
	NEAR(r.rest_e[3], m.rest_e[3], 1e-11);
	NEAR(r.known.corner[1][5][1], m.known.corner[1][5][1], 1e-11);
	assert_true(r.known.beyond == 0.25);
	assert_true(r.camera.width == 1280 && r.camera.focal_px == 6000 && r.camera.cam_from_head[3][3] == 1);
	skin_model_free(&r);
	// A matrix of another model beside it.
	m.n_lid_pc = 5;
	assert_true(skin_model_save(&m, scratch_path("other"), 0, &err));
	char *text;
	size_t size;
	assert_true(file_read(&text, &size, scratch_path("other/model_K.npy"), 1 << 20, &err));
	scratch_write("skin/model_K.npy", text, size);
	free(text);
	assert_false(skin_model_load(&r, scratch_path("skin"), &err));
	ERR_HAS(err, "model_K.npy: shape (40, 5), must be (40, 6)");
	err = (struct err){ 0 };
	scratch_text("skin/model.json", "{\"inputs\":[]}");
	assert_false(skin_model_load(&r, scratch_path("skin"), &err));
	ERR_HAS(err, "inputs");
	m.n_lid_pc = 6;
	skin_model_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(aperture), cmocka_unit_test(folded), cmocka_unit_test(baseline), cmocka_unit_test(files),
	};
	return cmocka_run_group_tests(tests, scratch_setup, scratch_teardown);
}
