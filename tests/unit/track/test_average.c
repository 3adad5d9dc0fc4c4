/* Skin of an average face: a sheet that looks forwards, without the nose, in proportion to the eyes' distance. */
#include "tests/lib/unit.h"
#include "track/clip/average.h"

static void sheet(void **state)
{
	(void)state;
	struct mesh small, large;
	average_skin(&small, 31.5);
	average_skin(&large, 63);
	assert_true(small.n_faces > 1000 && small.n_faces == large.n_faces && small.n_vertices == large.n_vertices);
	float(*normal)[3] = mesh_normals(&small);
	for (int i = 0; i < small.n_vertices; i++) {
		const float *v = small.vertices[i];
		NEAR(v[2], 12 - 0.005 * v[0] * v[0], 1e-5);
		assert_true(normal[i][2] > 0.8);
		for (int k = 0; k < 3; k++)
			NEAR(large.vertices[i][k], 2 * v[k], 1e-4);
	}
	for (int f = 0; f < small.n_faces; f++) {
		double middle[2] = { 0 };
		for (int c = 0; c < 3; c++) {
			assert_true(small.faces[f][c] >= 0 && small.faces[f][c] < small.n_vertices);
			for (int k = 0; k < 2; k++)
				middle[k] += small.vertices[small.faces[f][c]][k] / 3.0;
		}
		assert_true(fabs(middle[0]) > 13 || middle[1] > -9);
	}
	free(normal);
	mesh_free(&small);
	mesh_free(&large);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(sheet) };
	return cmocka_run_group_tests(tests, NULL, NULL);
}
