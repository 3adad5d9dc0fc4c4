/* Meshes: round trips, and hostile files refused before a library takes them at their word. */
#include "tests/lib/unit.h"

#include "base/file.h"
#include "base/mem.h"
#include "bridge/om_mesh.h"
#include "mesh/mesh_clean.h"
#include "mesh/mesh_joins.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/scratch.h"

/* A closed sphere of radius 2, rings × around, colours by place. */
static struct mesh sphere(int rings, int around)
{
	struct mesh m = { .n_vertices = rings * around + 2, .n_faces = 2 * rings * around };
	m.vertices = mem_new((size_t)m.n_vertices, sizeof *m.vertices);
	m.colours = mem_new((size_t)m.n_vertices, sizeof *m.colours);
	m.faces = mem_new((size_t)m.n_faces, sizeof *m.faces);
	int top = rings * around, bottom = top + 1, f = 0;
	m.vertices[top][2] = 2;
	m.vertices[bottom][2] = -2;
	for (int i = 0; i < rings; i++)
		for (int j = 0; j < around; j++) {
			double lat = M_PI * (i + 1) / (rings + 1), lon = 2 * M_PI * j / around;
			float *v = m.vertices[i * around + j], *c = m.colours[i * around + j];
			v[0] = (float)(2 * sin(lat) * cos(lon));
			v[1] = (float)(2 * sin(lat) * sin(lon));
			v[2] = (float)(2 * cos(lat));
			c[0] = (float)i / (float)rings;
			c[1] = (float)j / (float)around;
			int a = i * around + j, b = i * around + (j + 1) % around, above = a - around, beside = b - around;
			if (!i)
				memcpy(m.faces[f++], (int32_t[]){ top, a, b }, sizeof *m.faces);
			else {
				memcpy(m.faces[f++], (int32_t[]){ above, a, b }, sizeof *m.faces);
				memcpy(m.faces[f++], (int32_t[]){ above, b, beside }, sizeof *m.faces);
			}
			if (i == rings - 1)
				memcpy(m.faces[f++], (int32_t[]){ a, bottom, b }, sizeof *m.faces);
		}
	m.n_faces = f;
	return m;
}

static double area_and_volume(const struct mesh *m, double *volume)
{
	double area = 0;
	*volume = 0;
	for (int f = 0; f < m->n_faces; f++) {
		const float *a = m->vertices[m->faces[f][0]], *b = m->vertices[m->faces[f][1]], *c = m->vertices[m->faces[f][2]];
		double e[3], g[3];
		for (int k = 0; k < 3; k++) {
			e[k] = (double)b[k] - (double)a[k];
			g[k] = (double)c[k] - (double)a[k];
		}
		double n[3] = { e[1] * g[2] - e[2] * g[1], e[2] * g[0] - e[0] * g[2], e[0] * g[1] - e[1] * g[0] };
		area += sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 2;
		*volume += (n[0] * (double)a[0] + n[1] * (double)a[1] + n[2] * (double)a[2]) / 6;
	}
	return area;
}

static void ply_round_trip(void **state)
{
	(void)state;
	struct mesh m = sphere(20, 40), back;
	struct err err = { 0 };
	const char *path = scratch_path("m.bin");
	assert_true(om_mesh_save(&m, path, "{\"stage\":\"test\"}\nelement", &err));
	if (!om_mesh_load(&back, path, 10000, &err))
		fail_msg("%s", err.msg);
	assert_int_equal(back.n_vertices, m.n_vertices);
	assert_int_equal(back.n_faces, m.n_faces);
	assert_memory_equal(back.vertices, m.vertices, (size_t)m.n_vertices * sizeof *m.vertices);
	assert_memory_equal(back.faces, m.faces, (size_t)m.n_faces * sizeof *m.faces);
	for (int i = 0; i < m.n_vertices; i++)
		for (int k = 0; k < 3; k++)  // 8 bits of sRGB: half a step is at most 0.0045 in linear values
			NEAR(back.colours[i][k], m.colours[i][k], 0.0046);
	mesh_free(&back);
	mesh_free(&m);
}

static void obj_by_hand(void **state)
{
	(void)state;
	struct mesh m;
	struct err err = { 0 };
	// A square as one polygon, by each kind of index.
	const char *path = scratch_text("m.ply", "# a square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\n"
	                                         "f 1/1/1 2/1/1 3/1/1 -1/1/1\n");
	if (!om_mesh_load(&m, path, 100, &err))
		fail_msg("%s", err.msg);
	assert_int_equal(m.n_vertices, 4);
	assert_int_equal(m.n_faces, 2);
	double volume;
	NEAR(area_and_volume(&m, &volume), 1, 1e-12);
	float (*n)[3] = mesh_normals(&m);
	NEAR(n[0][2], 1, 1e-7);
	free(n);
	mesh_free(&m);
}

/* What readers stumble over though the format allows it: numbers of every type, with points and exponents where whole
 * numbers are asked for, polygons, corners twice, unused lists and properties, colours as shares of one. */
static void ply_by_hand(void **state)
{
	(void)state;
	struct mesh m;
	struct err err = { 0 };
	const char *path = scratch_text("m.ply",
	                                "ply\nformat ascii 1.0\ncomment element face 9999999\nelement vertex 4\nproperty int z\n"
	                                "property double y\nproperty short x\nproperty float red\nproperty float green\n"
	                                "property float blue\nproperty uchar quality\nelement face 3\nproperty int flags\n"
	                                "property list uchar float weights\nproperty list int uint vertex_index\n"
	                                "property uchar red\nend_header\n"
	                                "0 0 0 1 0 0.5 1.5\n0.0 0e0 1 1 0 .5 2e0\n0 1 1 1 0 0.5 3\n0 1 0 1 0 0.5 4\n"
	                                "7.5 2 0.1 0.2 4 0 1 2 3 99999.5\n8 0 3 0 0 1 1\n9 1 -4e9 3 0 1 0 7\n");
	if (!om_mesh_load(&m, path, 100, &err))
		fail_msg("%s", err.msg);
	assert_int_equal(m.n_vertices, 4);
	assert_int_equal(m.n_faces, 2);
	double volume;
	NEAR(area_and_volume(&m, &volume), 1, 1e-12);
	for (int i = 0; i < 4; i++) {
		NEAR(m.colours[i][0], 1, 1e-6);
		NEAR(m.colours[i][1], 0, 1e-6);
		NEAR(m.colours[i][2], 0.2140, 0.0046);  // 0.5 in sRGB, in steps of 1/255
	}
	mesh_free(&m);
}

#define HEAD(format, n, m) \
	"ply\nformat " format " 1.0\nelement vertex " n "\nproperty float x\nproperty float y\nproperty float z\n" \
	"element face " m "\nproperty list uchar int vertex_indices\nend_header\n"
#define THREE "0 0 0\n1 0 0\n0 1 0\n"

static void hostile_files_are_refused(void **state)
{
	(void)state;
	static const struct {
		const char *text, *says;
	} faults[] = {
		{ "", "is empty" },
		{ "hello\n", "is no mesh" },
		{ "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", "line 4: a corner that is no vertex" },
		{ "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 0\n", "line 4" },
		{ "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 -4\n", "line 4" },
		{ "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2\n", "2 corners" },
		{ "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n", "line 4" },
		{ "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "no number" },
		{ "v 0 0 1e30\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "vertex 0: coordinate = 1e+30, must be within" },
		{ "v 0 0 1e60\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "no number" },
		{ HEAD("ascii", "3", "1") THREE "3 0 1 3\n", "corner 3 is no vertex" },
		{ HEAD("ascii", "3", "1") THREE "3 0 1 -1\n", "no vertex" },
		{ HEAD("ascii", "3", "1") THREE "2 0 1\n", "2 corners" },
		{ HEAD("ascii", "3", "2") THREE "3 0 1 2\n", "ends in its face 1" },
		{ HEAD("ascii", "3", "0") "0 0 0\n1 nan 0\n0 1 0\n", "no number" },
		{ HEAD("ascii", "4", "0") THREE, "ends in row 3 of 4" },
		{ HEAD("ascii", "2000000", "0") THREE, "must be <= 1000" },
		{ HEAD("binary_little_endian", "900", "0") THREE, "of 900" },
		{ HEAD("binary_little_endian", "-5", "0"), "element vertex -5" },
		{ HEAD("ascii", "99999999999999999999", "0"), "must be <= 1000" },
		{ HEAD("middle_endian", "3", "0") THREE, "middle_endian" },
		{ "ply\nformat ascii 1.0\nelement vertex 1\nproperty list uchar int x\nend_header\n", "lists in vertices" },
		{ "ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n", "type of property" },
		{ "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n0\n", "x, y and z" },
		{ "ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n3 0 0 0\n",
		  "must be elements vertex, then face" },
		{ "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nnonsense\nend_header\n", "nonsense" },
		{ "ply\nformat ascii 1.0\nelement vertex 3\n", "head does not end" },
	};
	for (size_t i = 0; i < sizeof faults / sizeof *faults; i++) {
		struct mesh m;
		struct err err = { 0 };
		const char *path = scratch_text("m.obj", faults[i].text);
		if (om_mesh_load(&m, path, 1000, &err))
			fail_msg("accepted: %s", faults[i].text);
		ERR_HAS(err, faults[i].says);
		ERR_HAS(err, "m.obj: ");
		assert_null(m.vertices);
	}
}

/* Cut or flipped anywhere, a file is either refused or gives a mesh whose faces have vertices. */
static void damage_does_no_harm(void **state)
{
	(void)state;
	struct mesh m = sphere(4, 6);
	struct err err = { 0 };
	char *data;
	size_t size = 0;
	const char *path = scratch_path("m.ply");
	assert_true(om_mesh_save(&m, path, 0, &err) && file_read(&data, &size, path, 1 << 20, &err));
	for (size_t i = 0; i < 2 * size; i++) {
		struct mesh got;
		struct err e = { 0 };
		char *copy = mem_new(size + 1, 1);
		memcpy(copy, data, size);
		size_t n = i < size ? i : size;
		if (i >= size)
			copy[i - size] ^= (char)(1 << i % 8);
		if (om_mesh_load(&got, scratch_write("damaged", copy, n), 1000, &e))
			for (int f = 0; f < got.n_faces; f++)
				for (int k = 0; k < 3; k++)
					assert_in_range(got.faces[f][k], 0, got.n_vertices - 1);
		else
			assert_true(err_is(&e));
		mesh_free(&got);
		free(copy);
	}
	free(data);
	mesh_free(&m);
}

/* n triangles round the vertex 0 of the n + 2 that there are, every second of its fan. */
static const char *fan_file(const char *name, int n, bool as_obj)
{
	char *text = 0;
	size_t size = 0;
	FILE *out = open_memstream(&text, &size);
	if (!as_obj)
		fprintf(out, "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\nproperty float z\n"
		             "element face %d\nproperty list uchar int vertex_indices\nend_header\n", 2 * n + 1, n);
	for (int i = 0; i <= 2 * n; i++)
		fprintf(out, as_obj ? "v %d %d 0\n" : "%d %d 0\n", i, (int)((long)i * i % 1000));
	for (int i = 0; i < n; i++)
		fprintf(out, as_obj ? "f 1 %d %d\n" : "3 0 %d %d\n", 2 * i + 1 + as_obj, 2 * i + 2 + as_obj);
	fclose(out);
	const char *path = scratch_text(name, text);
	free(text);
	return path;
}

/* Work that grows with the square of a vertex's faces is refused: 100 000 of them would be joined for minutes, while the
 * same number of a sound mesh takes no time. */
static void fans_without_end_are_refused(void **state)
{
	(void)state;
	for (int as_obj = 0; as_obj < 2; as_obj++) {
		struct mesh m;
		struct err err = { 0 };
		assert_false(om_mesh_load(&m, fan_file("m.mesh", 100000, as_obj), 1000000, &err));
		ERR_HAS(err, "100000 faces meet in vertex 0");
		err = (struct err){ 0 };
		if (!om_mesh_load(&m, fan_file("m.mesh", 1000, as_obj), 1000000, &err))
			fail_msg("%s", err.msg);
		assert_int_equal(m.n_faces, 1000);
		mesh_free(&m);
	}
}

/* One polygon may name a vertex many times: its triangles count, not its line. */
static void long_polygons_count_as_triangles(void **state)
{
	(void)state;
	struct mesh m;
	struct err err = { 0 };
	char text[8000] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1";
	for (int i = 0; i < 1500; i++)
		strcat(text, i % 2 ? " 2" : " 3");
	strcat(text, "\n");
	assert_false(om_mesh_load(&m, scratch_text("m.obj", text), 1000, &err));
	ERR_HAS(err, "line 4: triangle 1001: must be <= 1000");
	struct mesh many = sphere(200, 300);
	err = (struct err){ 0 };
	for (int f = 0; f < many.n_faces; f++)
		many.faces[f][0] = 0;
	assert_false(om_mesh_decimate(&many, 100, &err));
	ERR_HAS(err, "faces meet in vertex 0");
	mesh_free(&many);
}

static void three_faces_at_one_edge(void **state)
{
	(void)state;
	float vertices[5][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, -1, 0 }, { 0, 0, 1 } };
	int32_t faces[3][3] = { { 0, 1, 2 }, { 1, 0, 3 }, { 0, 1, 4 } };
	struct mesh m = { 5, 3, vertices, faces, 0 }, back;
	struct err err = { 0 };
	double volume, want = area_and_volume(&m, &volume);
	const char *path = scratch_path("m.ply");
	assert_true(om_mesh_save(&m, path, 0, &err) && om_mesh_load(&back, path, 100, &err));
	assert_int_equal(back.n_faces, 3);
	assert_memory_equal(back.vertices, vertices, sizeof vertices);  // rows stay rows: landmarks count them
	NEAR(area_and_volume(&back, &volume), want, 1e-12);
	mesh_free(&back);
}

/* Faces that join as OpenMesh would join them stay as they are; others get vertices of their own, behind all others. */
static void what_is_no_surface_is_taken_apart(void **state)
{
	(void)state;
	static const struct {
		const char *what;
		int n_faces, added;
		int32_t faces[8][3];
	} cases[] = {
		{ "two faces at an edge", 2, 0, { { 0, 1, 2 }, { 1, 0, 3 } } },
		{ "wound against each other", 2, 3, { { 0, 1, 2 }, { 0, 1, 3 } } },
		{ "three at an edge", 3, 3, { { 0, 1, 2 }, { 1, 0, 3 }, { 0, 1, 4 } } },
		{ "a closed ring", 4, 0, { { 0, 1, 2 }, { 0, 3, 1 }, { 0, 2, 3 }, { 1, 3, 2 } } },
		{ "two closed ones that touch in a point", 8, 9,
		  { { 0, 1, 2 }, { 0, 3, 1 }, { 0, 2, 3 }, { 1, 3, 2 }, { 0, 4, 5 }, { 0, 6, 4 }, { 0, 5, 6 }, { 4, 6, 5 } } },
		{ "twice the same", 2, 3, { { 0, 1, 2 }, { 0, 1, 2 } } },
	};
	for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
		float vertices[7][3] = { { 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 }, { -1, 0, 0 }, { 0, -1, 0 }, { 0, 0, -1 } };
		int32_t faces[8][3];
		memcpy(faces, cases[c].faces, sizeof faces);
		struct mesh m = { 7, cases[c].n_faces, vertices, faces, 0 }, back;
		struct err err = { 0 };
		double volume, area = area_and_volume(&m, &volume);
		const char *path = scratch_path("m.ply");
		assert_int_equal(mesh_joins_sound(&m), !cases[c].added);
		assert_true(om_mesh_save(&m, path, 0, &err) && om_mesh_load(&back, path, 100, &err));
		if (back.n_vertices != 7 + cases[c].added)
			fail_msg("%s: %d vertices, must be %d", cases[c].what, back.n_vertices, 7 + cases[c].added);
		assert_int_equal(back.n_faces, cases[c].n_faces);
		assert_memory_equal(back.vertices, vertices, sizeof vertices);
		assert_true(mesh_joins_sound(&back));
		NEAR(area_and_volume(&back, &volume), area, 1e-12);
		mesh_free(&back);
	}
}

static void decimated_sphere_stays_one(void **state)
{
	(void)state;
	struct mesh m = sphere(60, 80);
	struct err err = { 0 };
	double volume, area = area_and_volume(&m, &volume), full = 4.0 / 3 * M_PI * 8;
	assert_true(fabs(volume / full - 1) < 0.005);  // the sphere of the test itself is one, and closed
	if (!om_mesh_decimate(&m, 1000, &err))
		fail_msg("%s", err.msg);
	assert_true(m.n_faces <= 1000 && m.n_faces > 900);
	// An inscribed polyhedron of N near-equilateral triangles loses about 5.5 / N of the volume; quadrics place
	// vertices off the surface, so a few times that.
	double after_volume, after = area_and_volume(&m, &after_volume);
	NEAR(after_volume / volume, 1, 0.02);
	NEAR(after / area, 1, 0.02);
	mesh_free(&m);
	m = sphere(4, 6);
	assert_true(om_mesh_decimate(&m, 100000, &err));  // nothing to do
	assert_int_equal(m.n_vertices, 26);
	mesh_free(&m);
}

static void real_meshes_load(void **state)
{
	(void)state;
	const char *path = bench_data("eyeballs/eyeball.obj");
	struct mesh m;
	struct err err = { 0 };
	if (!path) {
		print_message("no shared data: set EYEWRIGHT_DATA\n");
		skip();
	}
	if (!om_mesh_load(&m, path, 1000000, &err))
		fail_msg("%s", err.msg);
	assert_true(m.n_vertices > 100 && m.n_faces > 100);
	mesh_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		SCRATCH_TEST(ply_round_trip),
		SCRATCH_TEST(ply_by_hand),
		SCRATCH_TEST(obj_by_hand),
		SCRATCH_TEST(hostile_files_are_refused),
		SCRATCH_TEST(damage_does_no_harm),
		SCRATCH_TEST(fans_without_end_are_refused),
		SCRATCH_TEST(long_polygons_count_as_triangles),
		SCRATCH_TEST(three_faces_at_one_edge),
		SCRATCH_TEST(what_is_no_surface_is_taken_apart),
		cmocka_unit_test(decimated_sphere_stays_one),
		cmocka_unit_test(real_meshes_load),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
