/* A character's file read in a process of its own: what is kept, and what hostile files do. */
#include <time.h>
#include <zlib.h>

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

/* A mesh of 200 materials whose primitives share their vertices: one surface, as of one material, and each material on its faces. */
static void materials_of_one_mesh_keep_it_whole(void **state)
{
	(void)state;
	struct mesh mesh[2];
	struct look look[2];
	struct err err = { 0 };
	for (int k = 0; k < 2; k++) {
		written("many.glb", &(struct dressed){ .unit = 1, .used_materials = 200 * k, .texture_px = 16 });
		if (!take(&mesh[k], &look[k], "many.glb", &err))
			fail_msg("%s", err.msg);
	}
	assert_int_equal(mesh[1].n_vertices, mesh[0].n_vertices);
	assert_int_equal(mesh[1].n_faces, mesh[0].n_faces);
	assert_int_equal(look[1].n_parts, 3);
	int distinct = 0;
	bool *used = calloc((size_t)look[1].n_materials + 1, sizeof *used);
	for (int f = 0; f < look[1].n_faces; f++)
		if (!look[1].face_part[f]) {
			distinct += !used[look[1].face_material[f]];
			used[look[1].face_material[f]] = true;
			assert_int_equal(strncmp(look[1].material[look[1].face_material[f]].name, "Skin", 4), 0);
		}
	assert_int_equal(distinct, 200);
	for (int s = 0; s < 3; s++)  // blend shapes move as many points
		assert_int_equal(look[1].shape_start[s + 1], look[0].shape_start[s + 1]);
	free(used);
	for (int k = 0; k < 2; k++) {
		mesh_free(&mesh[k]);
		look_free(&look[k]);
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
		refuses("cut.glb", part ? "ends after" : "");
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

/* Bytes that grow. */
struct bytes {
	uint8_t *data;
	size_t size;
};

static void put_bytes(struct bytes *b, const void *data, size_t size)
{
	b->data = realloc(b->data, b->size + size + 1);
	memcpy(b->data + b->size, data, size);
	b->size += size;
}

static void put_u32(struct bytes *b, uint32_t x, bool big)
{
	const uint8_t le[4] = { (uint8_t)x, (uint8_t)(x >> 8), (uint8_t)(x >> 16), (uint8_t)(x >> 24) }, be[4] = { le[3], le[2], le[1], le[0] };
	put_bytes(b, big ? be : le, 4);
}

/* So many zeros, deflated: a thousandth of them. */
static struct bytes zeros(size_t n)
{
	struct bytes out = { 0 };
	uint8_t piece[65536], none[65536] = { 0 };
	z_stream z = { 0 };
	assert_int_equal(deflateInit(&z, 9), Z_OK);
	for (int end = Z_OK; end != Z_STREAM_END;) {
		z.avail_out = sizeof piece;
		z.next_out = piece;
		if (!z.avail_in && n) {
			z.next_in = none;
			z.avail_in = (uInt)(n < sizeof none ? n : sizeof none);
			n -= z.avail_in;
		}
		end = deflate(&z, n || z.avail_in ? Z_NO_FLUSH : Z_FINISH);
		put_bytes(&out, piece, sizeof piece - z.avail_out);
	}
	deflateEnd(&z);
	return out;
}

static void put_chunk(struct bytes *png, const char *kind, const struct bytes *what)
{
	put_u32(png, (uint32_t)what->size, true);
	const size_t from = png->size;
	put_bytes(png, kind, 4);
	put_bytes(png, what->data, what->size);
	put_u32(png, (uint32_t)crc32(0, png->data + from, (uInt)(png->size - from)), true);
}

/* A PNG of px x px, whose picture unpacks to `inside` bytes, with so many texts that unpack to seven megabytes each. */
static struct bytes bomb(uint32_t px, size_t inside, int texts)
{
	struct bytes png = { 0 }, head = { 0 }, text = { 0 }, idat = zeros(inside), seven = zeros(7000000), end = { 0 };
	put_bytes(&png, "\x89PNG\r\n\x1a\n", 8);
	put_u32(&head, px, true);
	put_u32(&head, px, true);
	put_bytes(&head, "\x08\x06\0\0\0", 5);
	put_chunk(&png, "IHDR", &head);
	put_bytes(&text, "k\0\0", 3);
	put_bytes(&text, seven.data, seven.size);
	for (int i = 0; i < texts; i++)
		put_chunk(&png, "zTXt", &text);
	put_chunk(&png, "IDAT", &idat);
	put_chunk(&png, "IEND", &end);
	free(head.data);
	free(text.data);
	free(idat.data);
	free(seven.data);
	return png;
}

static bool decode(void *ctx, struct apart_out *out, struct err *err)
{
	const struct bytes *png = ctx;
	struct look_texture t = { .bytes = png->data, .size = (long)png->size };
	int width, height;
	struct err why = { 0 };
	uint8_t *px = look_texture_check(&t, &why) ? look_texture_pixels(&width, &height, &t, 256, &why) : 0;
	(void)err;
	assert_true((px != 0) != err_is(&why));
	free(px);
	return apart_put(out, "done", 4);
}

/* Whatever a texture unpacks to, reading it takes no more memory than its pixels and some: it is taken, or refused. */
static void packed_textures_stay_small(void **state)
{
	(void)state;
	if (SANITISED)
		skip();  // a sanitizer takes addresses without end
	static const struct { uint32_t px; size_t inside; int texts; } bombs[] = { { 64, (size_t)1 << 30, 0 }, { 64, 64 * 257, 1000 }, { 8192, (size_t)1 << 20, 0 } };
	for (int i = 0; i < 3; i++) {
		struct bytes png = bomb(bombs[i].px, bombs[i].inside, bombs[i].texts);
		char *data;
		size_t size;
		struct err err = { 0 };
		const size_t pixels = 4 * (size_t)bombs[i].px * bombs[i].px;
		const struct apart apart = { decode, &png, 0, pixels + ((size_t)64 << 20), 1 << 10, 20 };
		if (!apart_run(&data, &size, &apart, &err))
			fail_msg("bomb %d: %s", i, err.msg);
		free(data);
		free(png.data);
	}
}

/* A record of a binary FBX (version 7400): 4 numbers, name, properties, records in it, 13 zeros. Returns where its end is to be written. */
static size_t fbx_open(struct bytes *b, const char *name, int n, const struct bytes *properties)
{
	const size_t at = b->size;
	const uint8_t length = (uint8_t)strlen(name);
	put_u32(b, 0, false);
	put_u32(b, (uint32_t)n, false);
	put_u32(b, (uint32_t)properties->size, false);
	put_bytes(b, &length, 1);
	put_bytes(b, name, length);
	put_bytes(b, properties->data, properties->size);
	return at;
}

static void fbx_close(struct bytes *b, size_t at, bool holds)
{
	static const uint8_t none[13];
	if (holds)
		put_bytes(b, none, sizeof none);
	const uint32_t end = (uint32_t)b->size;
	memcpy(b->data + at, &end, 4);
}

static void fbx_text(struct bytes *p, const char *text, size_t size)
{
	put_bytes(p, "S", 1);
	put_u32(p, (uint32_t)size, false);
	put_bytes(p, text, size);
}

static void fbx_id(struct bytes *p, int64_t id)
{
	put_bytes(p, "L", 1);
	put_bytes(p, &id, 8);
}

/* A mesh whose vertices are `claims` doubles, deflated from `inside` bytes of zeros. */
static struct bytes packed_fbx(uint32_t claims, size_t inside)
{
	struct bytes b = { 0 }, none = { 0 }, p = { 0 }, packed = zeros(inside);
	put_bytes(&b, "Kaydara FBX Binary  \0\x1a\0", 23);
	put_u32(&b, 7400, false);
	const size_t header = fbx_open(&b, "FBXHeaderExtension", 0, &none);
	put_bytes(&p, "I", 1);
	put_u32(&p, 7400, false);
	fbx_close(&b, fbx_open(&b, "FBXVersion", 1, &p), false);
	fbx_close(&b, header, true);
	p.size = 0;
	const size_t objects = fbx_open(&b, "Objects", 0, &none);
	fbx_id(&p, 100);
	fbx_text(&p, "quad\0\1Geometry", 14);
	fbx_text(&p, "Mesh", 4);
	const size_t geometry = fbx_open(&b, "Geometry", 3, &p);
	struct bytes array = { 0 };
	put_bytes(&array, "d", 1);
	put_u32(&array, claims, false);
	put_u32(&array, 1, false);
	put_u32(&array, (uint32_t)packed.size, false);
	put_bytes(&array, packed.data, packed.size);
	fbx_close(&b, fbx_open(&b, "Vertices", 1, &array), false);
	struct bytes index = { 0 };
	put_bytes(&index, "i", 1);
	put_u32(&index, 3, false);
	put_u32(&index, 0, false);
	put_u32(&index, 12, false);
	put_bytes(&index, (int32_t[3]){ 0, 1, -3 }, 12);
	fbx_close(&b, fbx_open(&b, "PolygonVertexIndex", 1, &index), false);
	fbx_close(&b, geometry, true);
	p.size = 0;
	fbx_id(&p, 200);
	fbx_text(&p, "Quad\0\1Model", 11);
	fbx_text(&p, "Mesh", 4);
	fbx_close(&b, fbx_open(&b, "Model", 3, &p), true);
	fbx_close(&b, objects, true);
	const size_t connections = fbx_open(&b, "Connections", 0, &none);
	static const int64_t joins[][2] = { { 200, 0 }, { 100, 200 } };
	for (int i = 0; i < 2; i++) {
		p.size = 0;
		fbx_text(&p, "OO", 2);
		fbx_id(&p, joins[i][0]);
		fbx_id(&p, joins[i][1]);
		fbx_close(&b, fbx_open(&b, "C", 3, &p), false);
	}
	fbx_close(&b, connections, true);
	put_bytes(&b, (uint8_t[13]){ 0 }, 13);
	free(p.data);
	free(array.data);
	free(index.data);
	free(packed.data);
	return b;
}

/* Small files that unpack, repeat or claim themselves to be large. */
static void inflating_files_are_refused(void **state)
{
	(void)state;
	if (SANITISED)
		skip();
	static const char asset[] = "\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}]";
	struct bytes whole = packed_fbx(9, 72), large = packed_fbx(200000000, 1600000000), claims = packed_fbx(4000000000u, 72);
	char *text;
	struct mesh mesh;
	struct look look;
	struct err err = { 0 };
	scratch_write("whole.fbx", whole.data, whole.size);
	// Three vertices at one place: the reader comes as far as its face, which has no area. So what follows is not refused for its form.
	assert_false(take(&mesh, &look, "whole.fbx", &err));
	ERR_HAS(err, "has no faces");
	assert_true(large.size < 2000000);
	scratch_write("large.fbx", large.data, large.size);
	refuses("large.fbx", "");
	scratch_write("claims.fbx", claims.data, claims.size);
	refuses("claims.fbx", "");
	text = mem_printf("{%s,\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"accessors\":[{\"componentType\":5126,"
	                  "\"count\":1000000000,\"type\":\"VEC3\",\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":0,\"componentType\":5125},\"values\":{\"bufferView\":1}}}],"
	                  "\"bufferViews\":[{\"buffer\":0,\"byteLength\":4},{\"buffer\":0,\"byteOffset\":4,\"byteLength\":12}],"
	                  "\"buffers\":[{\"byteLength\":16,\"uri\":\"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAAAAAA==\"}]}", asset);
	scratch_text("sparse.gltf", text);
	free(text);
	refuses("sparse.gltf", "");
	text = mem_printf("{%s,\"extensionsUsed\":[\"KHR_draco_mesh_compression\"],\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"nodes\":[{\"mesh\":0}],"
	                  "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"extensions\":{\"KHR_draco_mesh_compression\":{\"bufferView\":0,\"attributes\":{\"POSITION\":0}}}}]}],"
	                  "\"accessors\":[{\"componentType\":5126,\"count\":1000000000,\"type\":\"VEC3\"}],\"bufferViews\":[{\"buffer\":0,\"byteLength\":16}],"
	                  "\"buffers\":[{\"byteLength\":16,\"uri\":\"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAAAAAA==\"}]}", asset);
	scratch_text("draco.gltf", text);
	free(text);
	refuses("draco.gltf", "");
	// Each node holds the next one twice: two to the power of forty.
	struct bytes twice = { 0 };
	text = mem_printf("{%s,\"nodes\":[", asset);
	put_bytes(&twice, text, strlen(text));
	free(text);
	for (int i = 0; i < 40; i++) {
		text = mem_printf("{\"children\":[%d,%d]},", i + 1, i + 1);
		put_bytes(&twice, text, strlen(text));
		free(text);
	}
	static const char last[] = "{\"mesh\":0}],\"meshes\":[{\"primitives\":[]}]}";
	put_bytes(&twice, last, sizeof last - 1);
	scratch_write("twice.gltf", twice.data, twice.size);
	refuses("twice.gltf", "");
	free(whole.data);
	free(large.data);
	free(claims.data);
	free(twice.data);
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
		if (SANITISED && (d == EATS || d == FALLS || d == FORKS))  // a sanitizer takes addresses without end, and signals to itself
			continue;
		char *data;
		size_t size;
		struct err err = { 0 };
		enum deed deed = d;
		// A second of processor time, but for memory: a busy machine takes its time to hand it out.
		const struct apart apart = { misbehave, &deed, scratch_path("."), (size_t)256 << 20, 1 << 20, d == EATS ? 20 : 1 };
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
		SCRATCH_TEST(packed_textures_stay_small),
		SCRATCH_TEST(inflating_files_are_refused),
		SCRATCH_TEST(materials_of_one_mesh_keep_it_whole),
		SCRATCH_TEST(a_process_apart_dies_alone),
		SCRATCH_TEST(a_busy_machine_refuses_nothing),
		cmocka_unit_test(results_are_not_trusted),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
