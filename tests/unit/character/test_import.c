/* A character's file read in a process of its own: what is kept, and what hostile files do. */
#include <time.h>

#include "base/apart.h"
#include "base/file.h"
#include "base/mem.h"
#include "character/import.h"
#include "character/texture.h"
#include "image/picture.h"
#include "tests/lib/scenes/dressed.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

static const struct character_limits limits = { 100000, 20, 1024 };

/* A grid bent round a cylinder, as a head, and a small box, as eyeballs. */
enum { AROUND = 24, ROWS = 12 };

static struct mesh head(void)
{
	struct mesh m = { .n_vertices = AROUND * ROWS + 4, .n_faces = 2 * AROUND * (ROWS - 1) + 4 };
	m.vertices = calloc((size_t)m.n_vertices, sizeof *m.vertices);
	m.faces = calloc((size_t)m.n_faces, sizeof *m.faces);
	int n = 0;
	for (int j = 0; j < ROWS; j++)
		for (int i = 0; i < AROUND; i++) {
			const double a = 2 * M_PI * (i + 0.25) / AROUND;
			memcpy(m.vertices[n++], (float[3]){ (float)(70 * sin(a)), 20.0f * (float)j, (float)(80 * cos(a)) }, 12);
		}
	n = 0;
	for (int j = 0; j + 1 < ROWS; j++)
		for (int i = 0; i < AROUND; i++) {
			const int a = AROUND * j + i, b = AROUND * j + (i + 1) % AROUND;
			memcpy(m.faces[n++], (int32_t[3]){ a, b, b + AROUND }, 12);
			memcpy(m.faces[n++], (int32_t[3]){ a, b + AROUND, a + AROUND }, 12);
		}
	for (int i = 0; i < 4; i++) {
		memcpy(m.vertices[AROUND * ROWS + i], (float[3]){ 10.0f * (i == 1), 100 + 10.0f * (i == 2), 60 + 10.0f * (i == 3) }, 12);
		for (int k = 0; k < 3; k++)
			m.faces[n + i][k] = AROUND * ROWS + (i + k + 1 + (k == 1 && i % 2) - (k == 2 && i % 2)) % 4;
	}
	return m;
}

static const char *written(const char *name, const struct dressed *how)
{
	struct mesh m = head();
	struct err err = { 0 };
	const char *path = scratch_path("%s", name);
	assert_true(dressed_write(path, &m, how, &err));
	mesh_free(&m);
	return path;
}

static bool take(struct mesh *mesh, struct look *look, const char *name, struct err *err)
{
	return character_import(mesh, look, scratch_path("."), name, &limits, err);
}

/* Every vertex of the mesh is a point of the character where the file's nodes put it, and no more points than vertices. */
static void surface_is_where_the_nodes_put_it(void **state)
{
	(void)state;
	static const struct dressed hows[] = { { .unit = 0.001, .texture_px = 64 }, { .unit = 100, .z_up = true, .texture_px = 64 },
		                                   { .unit = 1, .skinned = true, .texture_px = 64 } };
	for (int h = 0; h < 3; h++) {
		struct mesh from = head(), got;
		struct look look;
		struct err err = { 0 };
		written("head.glb", &hows[h]);
		if (!take(&got, &look, "head.glb", &err))
			fail_msg("%s", err.msg);
		assert_int_equal(look.n_parts, 3);
		assert_int_equal(got.n_vertices, from.n_vertices + 4 * 24);  // the seam is closed; 24 hair cards
		for (int i = 0; i < from.n_vertices; i++) {
			float want[3], least = INFINITY;
			dressed_place(want, from.vertices[i], &hows[h]);
			if (hows[h].skinned)  // the joint's quarter turn about x, the node's scale left out
				memcpy(want, (float[3]){ want[0], -want[2], want[1] }, sizeof want);
			for (int k = 0; k < got.n_vertices; k++)
				least = fminf(least, hypotf(hypotf(got.vertices[k][0] - want[0], got.vertices[k][1] - want[1]), got.vertices[k][2] - want[2]));
			assert_true(least <= 1e-5f * 250 * (float)hows[h].unit);
		}
		mesh_free(&from);
		mesh_free(&got);
		look_free(&look);
	}
}

static void look_is_kept(void **state)
{
	(void)state;
	struct mesh mesh;
	struct look look, again;
	struct err err = { 0 };
	written("head.glb", &(struct dressed){ .unit = 0.001, .texture_px = 128 });
	assert_true(take(&mesh, &look, "head.glb", &err));
	assert_string_equal(look.part[0], "Head");
	assert_string_equal(look.part[2], "Hair");
	assert_int_equal(look.n_shapes, 3);
	assert_string_equal(look.shape[1], "eyeBlink_L");
	assert_true(look.shape_start[1] > 0 && look.shape_start[1] < mesh.n_vertices);
	for (int k = 0; k < look.shape_start[1]; k++)  // jawOpen: down alone, by at most 4 % of the head's height
		assert_true(look.shape_by[k][1] < 0 && look.shape_by[k][1] >= -0.04f * 0.22f - 1e-6f && look.shape_by[k][0] == 0);
	assert_int_equal(look.n_textures, 4);
	const struct look_material *skin = &look.material[look.face_material[0]];
	assert_string_equal(skin->name, "Skin");
	assert_true(skin->map[LOOK_COLOUR] >= 0 && skin->map[LOOK_NORMAL] >= 0 && skin->map[LOOK_ROUGH] >= 0);
	assert_int_equal(look.texture[skin->map[LOOK_COLOUR]].width, 128);
	const struct look_material *hair = &look.material[look.face_material[look.n_faces - 1]];
	assert_int_equal(hair->alpha, LOOK_MASK);
	assert_true(hair->two_sided && look.has_uv && look.n_wedges > mesh.n_vertices);
	for (int i = 0; i < look.n_wedges; i++)  // v runs down the head
		if (look.point[i] < AROUND * ROWS)
			NEAR(look.uv[i][1], (0.22f - mesh.vertices[look.point[i]][1]) / 0.22f, 1e-5);
	assert_true(look_save(&look, scratch_path("look.npz"), 0, &err) && look_load(&again, scratch_path("look.npz"), &err));
	assert_int_equal(again.n_faces, look.n_faces);
	assert_memory_equal(again.uv, look.uv, (size_t)look.n_wedges * sizeof *look.uv);
	assert_memory_equal(again.bytes, look.bytes, (size_t)look.n_bytes);
	look_free(&again);
	look_free(&look);
	mesh_free(&mesh);
}

static void without_uv_or_materials(void **state)
{
	(void)state;
	static const struct dressed hows[] = { { .unit = 1, .no_uv = true, .texture_px = 16 }, { .unit = 1, .no_material = true, .texture_px = 16 },
		                                   { .unit = 1, .many_materials = 200, .texture_px = 16 } };
	for (int h = 0; h < 3; h++) {
		struct mesh mesh;
		struct look look;
		struct err err = { 0 };
		written("bare.glb", &hows[h]);
		if (!take(&mesh, &look, "bare.glb", &err))
			fail_msg("%s", err.msg);
		assert_int_equal(look.has_uv, h != 0);
		mesh_free(&mesh);
		look_free(&look);
	}
}

/* An OBJ keeps its own rows, whatever order Assimp gives them. */
static void rows_of_an_obj_are_its_own(void **state)
{
	(void)state;
	struct mesh mesh;
	struct look look;
	struct err err = { 0 };
	scratch_text("quad.mtl", "newmtl red\nKd 1 0 0\nmap_Kd ..\\..\\elsewhere\\no.png\n");
	scratch_text("quad.obj", "mtllib quad.mtl\nusemtl red\nv 9 9 9\nv 1 0 0.3\nv 0 0 0.1\nv 0 1 0\nv 1 1 0\n"
	                         "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 3/1 2/2 5/3 4/4\n");
	assert_true(character_has_look(scratch_path("quad.obj")));
	assert_true(take(&mesh, &look, "quad.obj", &err));
	assert_int_equal(mesh.n_vertices, 5);
	assert_int_equal(mesh.n_faces, 2);
	NEAR(mesh.vertices[1][2], 0.3, 1e-7);
	for (int f = 0; f < 2; f++)
		for (int k = 0; k < 3; k++) {
			const int32_t v = mesh.faces[f][k];
			const float *uv = look.uv[look.corner[f][k]];
			NEAR(uv[0], mesh.vertices[v][0], 1e-6);
			NEAR(uv[1], 1 - mesh.vertices[v][1], 1e-6);
		}
	assert_int_equal(look.n_left_out, 1);
	assert_non_null(strstr(look.left_out[0], "no.png"));
	NEAR(look.material[look.face_material[0]].rgba[1], 0, 1e-6);
	mesh_free(&mesh);
	look_free(&look);
}

/* A PLY that names its texture keeps it, with the coordinates of its vertices; another is a surface alone. */
static void texture_of_a_ply_is_kept(void **state)
{
	(void)state;
	static const char rest[] = "element vertex 5\nproperty float x\nproperty float y\nproperty float z\nproperty float s\nproperty float t\n"
	                           "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
	                           "9 9 9 0 0\n1 0 0.3 1 0\n0 0 0.1 0 0\n0 1 0 0 1\n1 1 0 1 1\n3 2 1 4\n3 2 4 3\n";
	struct mesh mesh;
	struct look look;
	struct err err = { 0 };
	char text[1024];
	snprintf(text, sizeof text, "ply\nformat ascii 1.0\n%s", rest);
	scratch_text("plain.ply", text);
	assert_false(character_has_look(scratch_path("plain.ply")));
	scratch_text("corners.ply", "ply\nformat ascii 1.0\ncomment TextureFile no.png\nproperty list uchar float texcoord\nend_header\n");
	assert_false(character_has_look(scratch_path("corners.ply")));
	snprintf(text, sizeof text, "ply\nformat ascii 1.0\ncomment TextureFile no.png\n%s", rest);
	scratch_text("quad.ply", text);
	assert_true(character_has_look(scratch_path("quad.ply")));
	if (!take(&mesh, &look, "quad.ply", &err))
		fail_msg("%s", err.msg);
	assert_int_equal(mesh.n_vertices, 5);
	assert_int_equal(mesh.n_faces, 2);
	NEAR(mesh.vertices[1][2], 0.3, 1e-7);
	assert_true(look.has_uv);
	for (int f = 0; f < 2; f++)
		for (int k = 0; k < 3; k++) {
			const float *uv = look.uv[look.corner[f][k]], *x = mesh.vertices[mesh.faces[f][k]];
			NEAR(uv[0], x[0], 1e-6);
			NEAR(uv[1], 1 - x[1], 1e-6);
		}
	assert_int_equal(look.n_left_out, 1);
	assert_non_null(strstr(look.left_out[0], "no.png"));
	mesh_free(&mesh);
	look_free(&look);
}

/* A quad with a blend shape, and a texture where the artist had it. */
static const char fbx[] =
	"; FBX 7.4.0 project file\nFBXHeaderExtension:  {\nFBXHeaderVersion: 1003\nFBXVersion: 7400\n}\nGlobalSettings:  {\n"
	"Version: 1000\nProperties70:  {\nP: \"UpAxis\", \"int\", \"Integer\", \"\",1\n"
	"P: \"UnitScaleFactor\", \"double\", \"Number\", \"\",1\n}\n}\nObjects:  {\n"
	"Geometry: 100, \"Geometry::quad\", \"Mesh\" {\nVertices: *12 {\na: 0,0,0,10,0,0,10,10,3,0,10,0\n}\n"
	"PolygonVertexIndex: *4 {\na: 0,1,2,-4\n}\nGeometryVersion: 124\nLayerElementUV: 0 {\nVersion: 101\nName: \"map1\"\n"
	"MappingInformationType: \"ByPolygonVertex\"\nReferenceInformationType: \"IndexToDirect\"\nUV: *8 {\n"
	"a: 0,0,1,0,1,1,0,1\n}\nUVIndex: *4 {\na: 0,1,2,3\n}\n}\nLayerElementMaterial: 0 {\nVersion: 101\nName: \"\"\n"
	"MappingInformationType: \"AllSame\"\nReferenceInformationType: \"IndexToDirect\"\nMaterials: *1 {\na: 0\n}\n}\n"
	"Layer: 0 {\nVersion: 100\nLayerElement:  {\nType: \"LayerElementUV\"\nTypedIndex: 0\n}\nLayerElement:  {\n"
	"Type: \"LayerElementMaterial\"\nTypedIndex: 0\n}\n}\n}\nGeometry: 500, \"Geometry::smile\", \"Shape\" {\n"
	"Version: 100\nIndexes: *1 {\na: 2\n}\nVertices: *3 {\na: 0,0,2\n}\nNormals: *3 {\na: 0,0,0\n}\n}\n"
	"Model: 200, \"Model::Quad\", \"Mesh\" {\nVersion: 232\n}\nMaterial: 300, \"Material::red\", \"\" {\nVersion: 102\n"
	"ShadingModel: \"lambert\"\nMultiLayer: 0\nProperties70:  {\nP: \"DiffuseColor\", \"Color\", \"\", \"A\",1,0,0\n}\n}\n"
	"Texture: 400, \"Texture::t\", \"\" {\nType: \"TextureVideoClip\"\nVersion: 202\nTextureName: \"Texture::t\"\n"
	"FileName: \"C:\\Users\\artist\\skin.png\"\nRelativeFilename: \"..\\textures\\skin.png\"\n}\n"
	"Deformer: 600, \"Deformer::blend\", \"BlendShape\" {\nVersion: 100\n}\n"
	"Deformer: 700, \"SubDeformer::smile\", \"BlendShapeChannel\" {\nVersion: 100\nDeformPercent: 0\nFullWeights: *1 {\n"
	"a: 100\n}\n}\n}\nConnections:  {\nC: \"OO\",200,0\nC: \"OO\",100,200\nC: \"OO\",300,200\n"
	"C: \"OP\",400,300, \"DiffuseColor\"\nC: \"OO\",600,100\nC: \"OO\",700,600\nC: \"OO\",500,700\n}\n";

static void fbx_is_read(void **state)
{
	(void)state;
	struct mesh mesh;
	struct look look;
	struct err err = { 0 };
	uint8_t px[4 * 4 * 3] = { 0 };
	scratch_text("quad.fbx", fbx);
	assert_true(picture_png_write(scratch_path("skin.png"), px, 4, 4, 3, &err));
	if (!take(&mesh, &look, "quad.fbx", &err))
		fail_msg("%s", err.msg);
	assert_int_equal(mesh.n_vertices, 4);
	assert_int_equal(mesh.n_faces, 2);
	assert_string_equal(look.part[0], "Quad");
	const struct look_material *m = &look.material[look.face_material[0]];
	assert_string_equal(m->name, "red");
	assert_int_equal(m->map[LOOK_COLOUR], 0);
	assert_int_equal(look.texture[0].width, 4);
	assert_int_equal(look.n_shapes, 1);
	assert_int_equal(look.shape_start[1], 1);
	NEAR(look.shape_by[0][2], 2, 1e-5);
	NEAR(mesh.vertices[look.shape_point[0]][2], 3, 1e-5);
	for (int w = 0; w < look.n_wedges; w++) {
		NEAR(look.uv[w][0], mesh.vertices[look.point[w]][0] / 10, 1e-5);
		NEAR(look.uv[w][1], 1 - mesh.vertices[look.point[w]][1] / 10, 1e-5);
	}
	mesh_free(&mesh);
	look_free(&look);
}

static void refuses(const char *name, const char *why)
{
	struct mesh mesh;
	struct look look;
	struct err err = { 0 };
	if (take(&mesh, &look, name, &err))
		fail_msg("%s was taken", name);
	ERR_HAS(err, name);
	ERR_HAS(err, why);
	assert_null(strchr(err.msg, '\n'));
	assert_null(mesh.vertices);
}

static void hostile_files_are_refused_in_one_line(void **state)
{
	(void)state;
	char *data;
	size_t size;
	struct err err = { 0 };
	const char *path = written("whole.glb", &(struct dressed){ .unit = 1, .texture_px = 64 });
	assert_true(file_read(&data, &size, path, 1 << 26, &err));
	for (int part = 0; part < 9; part++) {
		scratch_write("cut.glb", data, size * (size_t)part / 9);
		refuses("cut.glb", "");
	}
	free(data);
	scratch_text("words.fbx", "not an FBX at all");
	refuses("words.fbx", "");
	scratch_text("cycle.gltf", "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"children\":[1]},{\"children\":[0]}]}");
	refuses("cycle.gltf", "");
	scratch_text("claims.gltf", "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
	                            "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"
	                            "\"count\":2000000000,\"type\":\"VEC3\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":24000000000}],"
	                            "\"buffers\":[{\"byteLength\":24000000000,\"uri\":\"data:application/octet-stream;base64,AAAA\"}]}");
	refuses("claims.gltf", "");
	scratch_text("out.gltf", "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],"
	                         "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,"
	                         "\"count\":3,\"type\":\"VEC3\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],"
	                         "\"buffers\":[{\"byteLength\":36,\"uri\":\"../../../../../../etc/passwd\"}]}");
	refuses("out.gltf", "");
}

/* A texture that claims 60000 px is left out by its head, and named; the character stays. */
static void huge_textures_are_left_out(void **state)
{
	(void)state;
	char *data;
	size_t size;
	struct err err = { 0 };
	struct mesh mesh;
	struct look look;
	const char *path = written("huge.glb", &(struct dressed){ .unit = 1, .texture_px = 64 });
	assert_true(file_read(&data, &size, path, 1 << 26, &err));
	for (size_t i = 0; i + 24 < size; i++)
		if (!memcmp(data + i, "IHDR\0\0\0\x40", 8))
			memcpy(data + i, "IHDR\0\0\xea\x60\0\0\xea\x60", 12);
	scratch_write("huge.glb", data, size);
	free(data);
	assert_true(take(&mesh, &look, "huge.glb", &err));
	assert_int_equal(look.n_textures, 3);
	assert_int_equal(look.n_left_out, 1);
	assert_non_null(strstr(look.left_out[0], "60000 x 60000 px"));
	assert_int_equal(look.material[look.face_material[0]].map[LOOK_COLOUR], -1);
	mesh_free(&mesh);
	look_free(&look);
}

enum deed { WRITES, OPENS, FORKS, EATS, SPINS, WAITS, FALLS, FLOODS };

static bool misbehave(void *ctx, struct apart_out *out, struct err *err)
{
	const enum deed *deed = ctx;
	char piece[4096] = { 0 };
	volatile long n = 0;
	switch (*deed) {
	case WRITES: return fopen("/tmp/eyewright-must-not-be", "w") || err_set(err, "no writing");
	case OPENS: return fopen("/etc/passwd", "r") || err_set(err, "no reading");
	case FORKS: return fork() >= 0 || err_set(err, "no processes");
	case EATS:
		for (;;)
			memset(mem_new(1 << 24, 1), 1, 1 << 24);
	case SPINS:
		for (;;)
			n++;
	case WAITS:
		for (;;)
			nanosleep(&(struct timespec){ .tv_sec = 1 }, 0);
	case FALLS: __builtin_trap();
	case FLOODS:
		while (apart_put(out, piece, sizeof piece))
			;
		return err_set(err, "no more room");
	}
	return true;
}

/* What a reader that was taken over tries comes to nothing, and this process goes on. */
static void a_process_apart_dies_alone(void **state)
{
	(void)state;
	static const char *const said[] = { "no writing", "no reading", "no processes", "memory", "longer than", "longer than", "died of signal 4", "no more room" };
	for (enum deed d = WRITES; d <= FLOODS; d++) {
#ifdef __SANITIZE_ADDRESS__
		if (d == EATS || d == FALLS || d == FORKS)  // a sanitizer takes addresses without end, and signals to itself
			continue;
#endif
		char *data;
		size_t size;
		struct err err = { 0 };
		enum deed deed = d;
		const struct apart apart = { misbehave, &deed, scratch_path("."), (size_t)256 << 20, 1 << 20, 1 };
		assert_false(apart_run(&data, &size, &apart, &err));
		ERR_HAS(err, said[d]);
		assert_null(data);
	}
	assert_false(file_exists("/tmp/eyewright-must-not-be"));
}

/* Four seconds by the clock, a tenth of them of processor time: as on a machine that has others' work to do. */
static bool goes_slowly(void *ctx, struct apart_out *out, struct err *err)
{
	(void)ctx;
	(void)err;
	volatile long n = 0;
	for (int i = 0; i < 40; i++) {
		for (clock_t from = clock(); clock() - from < CLOCKS_PER_SEC / 100;)
			n++;
		nanosleep(&(struct timespec){ .tv_nsec = 90000000 }, 0);
	}
	return apart_put(out, "sound", 5);
}

static void a_busy_machine_refuses_nothing(void **state)
{
	(void)state;
	char *data;
	size_t size;
	struct err err = { 0 };
	const struct apart apart = { goes_slowly, 0, 0, (size_t)256 << 20, 1 << 20, 1 };
	if (!apart_run(&data, &size, &apart, &err))
		fail_msg("%s", err.msg);
	assert_string_equal(data, "sound");
	free(data);
}

/* Whatever bytes a reader that was taken over hands out, none of them points outside. */
static void results_are_not_trusted(void **state)
{
	(void)state;
	struct mesh mesh;
	struct look look;
	struct err err = { 0 };
	unsigned char *bytes = calloc(4096, 1);
	uint32_t seed = 1;
	for (int i = 0; i < 4000; i++) {
		for (int k = 0; k < 200; k++)
			bytes[k] = (seed = seed * 1664525 + 1013904223) >> 29 ? 0 : (unsigned char)(seed >> 20);
		err = (struct err){ 0 };
		if (look_take(&look, &mesh, (const char *)bytes, (size_t)(i % 4096), &err)) {
			look_free(&look);
			mesh_free(&mesh);
		}
	}
	free(bytes);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		SCRATCH_TEST(surface_is_where_the_nodes_put_it),
		SCRATCH_TEST(look_is_kept),
		SCRATCH_TEST(without_uv_or_materials),
		SCRATCH_TEST(rows_of_an_obj_are_its_own),
		SCRATCH_TEST(texture_of_a_ply_is_kept),
		SCRATCH_TEST(fbx_is_read),
		SCRATCH_TEST(hostile_files_are_refused_in_one_line),
		SCRATCH_TEST(huge_textures_are_left_out),
		SCRATCH_TEST(a_process_apart_dies_alone),
		SCRATCH_TEST(a_busy_machine_refuses_nothing),
		cmocka_unit_test(results_are_not_trusted),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
