/* What is free before a surface, against closed forms: a ball, a ball's inside, a groove (Nusselt's analogue: the share of
 * an even sky through a long slit of half-angle a is sin a). */
#include "mesh/openness.h"
#include "tests/lib/unit.h"

static void hidden_is_of_little_openness(const struct mesh *mesh)
{
	float open[9];
	bool hidden[9];
	mesh_openness(open, mesh);
	for (int percent = 0; percent <= 100; percent += 5) {
		int n = 0;
		mesh_hidden(hidden, mesh, percent / 100.0);
		for (int i = 0; i < mesh->n_vertices; i++) {
			assert_int_equal(hidden[i], (double)open[i] < percent / 100.0);
			n += hidden[i];
		}
		assert_float_equal(mesh_hidden_share(mesh, percent / 100.0, 9), (double)n / mesh->n_vertices, 1e-12);
	}
}

static void groove(void **state)
{
	(void)state;
	enum { LONG = 400 };
	for (int degrees = 20; degrees <= 90; degrees += 35) {
		const float s = 100 * sinf((float)(degrees * M_PI / 180)), c = 100 * cosf((float)(degrees * M_PI / 180));
		// The bottom runs along y in three vertices; the walls rise to both sides.
		float v[9][3] = { { 0, -LONG, 0 }, { 0, 0, 0 }, { 0, LONG, 0 }, { s, -LONG, c }, { s, 0, c }, { s, LONG, c },
			{ -s, -LONG, c }, { -s, 0, c }, { -s, LONG, c } };
		int32_t f[8][3] = { { 0, 3, 4 }, { 0, 4, 1 }, { 1, 4, 5 }, { 1, 5, 2 }, { 0, 7, 6 }, { 0, 1, 7 }, { 1, 8, 7 }, { 1, 2, 8 } };
		struct mesh mesh = { .n_vertices = 9, .vertices = v, .n_faces = 8, .faces = f };
		float open[9];
		mesh_openness(open, &mesh);
		assert_float_equal(open[1], sin(degrees * M_PI / 180), 0.13);  // 24 rays, three deviations of strata at the walls
		hidden_is_of_little_openness(&mesh);
	}
}

static void closed_box(void **state)
{
	(void)state;
	float v[8][3];
	static const int32_t quad[6][4] = { { 0, 2, 3, 1 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 }, { 2, 6, 7, 3 }, { 0, 4, 6, 2 }, { 1, 3, 7, 5 } };
	int32_t out[12][3], in[12][3];
	for (int i = 0; i < 8; i++)
		for (int k = 0; k < 3; k++)
			v[i][k] = i >> k & 1 ? 10 : -10;
	for (int i = 0; i < 12; i++)
		for (int k = 0; k < 3; k++) {
			out[i][k] = quad[i / 2][k ? k + i % 2 : 0];
			in[i][2 - k] = out[i][k];
		}
	float open[8];
	struct mesh mesh = { .n_vertices = 8, .vertices = v, .n_faces = 12, .faces = out };
	mesh_openness(open, &mesh);
	for (int i = 0; i < 8; i++)
		assert_float_equal(open[i], 1, 0);
	assert_float_equal(mesh_hidden_share(&mesh, 0.5, 3), 0, 0);
	hidden_is_of_little_openness(&mesh);
	mesh.faces = in;
	mesh_openness(open, &mesh);
	for (int i = 0; i < 8; i++)
		assert_float_equal(open[i], 0, 0);
	assert_float_equal(mesh_hidden_share(&mesh, 0.5, 3), 1, 0);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(groove), cmocka_unit_test(closed_box) };
	return cmocka_run_group_tests(tests, 0, 0);
}
