/* rim: eyeballs from holes cut into a sheet along circles of known spheres (closed form), and what is no eye's hole. */
#include "tests/lib/unit.h"

#include "base/mem.h"
#include "track/clip/rim.h"

enum { AROUND = 40 };

/* A ring of skin round a hole: its inner edge lies on a sphere, where a slanted plane cuts it in an oval as wide as an eye. */
static struct mesh ring(const double center[3], double radius, double half)
{
	struct mesh m = { .n_vertices = 2 * AROUND, .n_faces = 2 * AROUND };
	m.vertices = mem_new(2 * AROUND, sizeof *m.vertices);
	m.faces = mem_new(2 * AROUND, sizeof *m.faces);
	for (int i = 0; i < AROUND; i++) {
		double a = 2 * M_PI * i / AROUND, x = half * cos(a), y = 0.5 * half * sin(a), z = sqrt(radius * radius - x * x - y * y);
		for (int out = 0; out < 2; out++) {
			double at[3] = { (1 + out) * x, (1 + out) * y, z + out };
			for (int k = 0; k < 3; k++)
				m.vertices[i + out * AROUND][k] = (float)(center[k] + at[k]);
		}
		int j = (i + 1) % AROUND;
		memcpy(m.faces[2 * i], (int32_t[3]){ i, i + AROUND, j + AROUND }, sizeof *m.faces);
		memcpy(m.faces[2 * i + 1], (int32_t[3]){ i, j + AROUND, j }, sizeof *m.faces);
	}
	return m;
}

static void test_known(void **state)
{
	(void)state;
	const double center[3] = { 31, 4, -20 };
	double got[3], radius;
	for (double r = 11; r < 17; r += 2) {
		struct mesh m = ring(center, r, 9);
		const float there[3] = { 22, 4, -10 }, elsewhere[3] = { -31, 4, -10 };
		assert_true(rim_eyeball(got, &radius, &m, true, there));
		NEAR(radius, r, 1e-3);  // the vertices are single precision
		for (int k = 0; k < 3; k++)
			NEAR(got[k], center[k], 1e-3);
		assert_true(rim_eyeball(got, &radius, &m, true, 0));
		assert_false(rim_eyeball(got, &radius, &m, false, 0));
		assert_false(rim_eyeball(got, &radius, &m, true, elsewhere));
		mesh_free(&m);
	}
}

static void test_no_eye(void **state)
{
	(void)state;
	const double center[3] = { 31, 4, -20 };
	double got[3], radius;
	struct mesh nostril = ring(center, 12, 4), mouth = ring(center, 60, 24), none = { 0 };
	assert_false(rim_eyeball(got, &radius, &nostril, true, 0));
	assert_false(rim_eyeball(got, &radius, &mouth, true, 0));
	assert_false(rim_eyeball(got, &radius, &none, true, 0));
	mesh_free(&nostril);
	mesh_free(&mouth);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(test_known), cmocka_unit_test(test_no_eye) };
	return cmocka_run_group_tests(tests, 0, 0);
}
