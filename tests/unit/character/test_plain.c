/* glTF files that are packed: what comes out is what was packed, by closed forms; damaged ones are refused in one line. */
#include <jansson.h>
#include <meshoptimizer.h>

#include "base/file.h"
#include "base/mem.h"
#include "character/import.h"
#include "character/texture.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

static const struct character_limits limits = { 100000, 20, 1536 };

/* A sheet of ACROSS x DOWN points, bulged; its numbers are whole, the node gives them their size. */
enum { ACROSS = 24, DOWN = 17, N = ACROSS * DOWN, CORNERS = 6 * (ACROSS - 1) * (DOWN - 1) };
static const double size = 0.002, away[3] = { 1, -2, 0.5 };

static uint16_t place(int i, int axis)
{
	const int x = i % ACROSS, y = i / ACROSS;
	return (uint16_t)(axis == 0 ? 400 * x : axis == 1 ? 500 * y + 7 * x : 20 * x * (ACROSS - x) + y);
}

/* Displacement of the one blend shape. */
static int16_t moved(int i, int axis)
{
	return (int16_t)(axis == 1 ? -3 * (i % 11) : i % 11 ? axis : 0);
}

static void turn(double uv[2], int i)
{
	// Offset, rotation of a quarter turn counter-clockwise as the picture is seen, scale.
	const double u = (i % ACROSS) / 65535. * 2000 * 0.5, v = (i / ACROSS) / 65535. * 3000 * 2;
	uv[0] = 0.25 + v;
	uv[1] = 0.125 - u;
}

struct packed {
	char data[1 << 16];
	size_t n;
	json_t *views, *accessors;
};

static json_t *view_of(struct packed *p, const void *bytes, size_t n)
{
	json_t *view = json_pack("{sisIsI}", "buffer", 0, "byteOffset", (json_int_t)p->n, "byteLength", (json_int_t)n);
	assert_true(p->n + n + 4 <= sizeof p->data);
	memcpy(p->data + p->n, bytes, n);
	p->n = (p->n + n + 3) & ~(size_t)3;
	return view;
}

static void add(struct packed *p, json_t *view, json_t *accessor)
{
	json_array_append_new(p->views, view);
	json_object_set_new(accessor, "bufferView", json_integer((json_int_t)json_array_size(p->views) - 1));
	json_array_append_new(p->accessors, accessor);
}

/* n elements of `stride` bytes as an accessor; compressed: by meshoptimizer's encoder, the view itself of a buffer that has no bytes. */
static void add_rows(struct packed *p, const void *rows, size_t n, size_t stride, int type, const char *shape, bool normalised, bool compressed)
{
	json_t *view;
	if (compressed) {
		static unsigned char out[1 << 16];
		const size_t got = meshopt_encodeVertexBuffer(out, sizeof out, rows, n, stride);
		assert_true(got > 0);
		json_t *of = view_of(p, out, got);
		json_object_set_new(of, "byteStride", json_integer((json_int_t)stride));
		json_object_set_new(of, "count", json_integer((json_int_t)n));
		json_object_set_new(of, "mode", json_string("ATTRIBUTES"));
		view = json_pack("{sisIsIs{so}}", "buffer", 1, "byteLength", (json_int_t)(n * stride), "byteStride", (json_int_t)stride, "extensions", "EXT_meshopt_compression", of);
	} else {
		view = view_of(p, rows, n * stride);
		json_object_set_new(view, "byteStride", json_integer((json_int_t)stride));
	}
	add(p, view, json_pack("{sisssIsb}", "componentType", type, "type", shape, "count", (json_int_t)n, "normalized", normalised));
}

static void add_corners(struct packed *p, bool compressed)
{
	static uint16_t corner[CORNERS];
	int n = 0;
	for (int y = 0; y + 1 < DOWN; y++)
		for (int x = 0; x + 1 < ACROSS; x++) {
			const int a = ACROSS * y + x, of[6] = { a, a + 1, a + ACROSS + 1, a, a + ACROSS + 1, a + ACROSS };
			for (int k = 0; k < 6; k++)
				corner[n++] = (uint16_t)of[k];
		}
	json_t *view;
	if (compressed) {
		static unsigned char out[1 << 16];
		unsigned wide[CORNERS];
		for (int k = 0; k < CORNERS; k++)
			wide[k] = corner[k];
		const size_t got = meshopt_encodeIndexBuffer(out, sizeof out, wide, CORNERS);
		json_t *of = view_of(p, out, got);
		json_object_set_new(of, "byteStride", json_integer(2));
		json_object_set_new(of, "count", json_integer(CORNERS));
		json_object_set_new(of, "mode", json_string("TRIANGLES"));
		view = json_pack("{sisis{so}}", "buffer", 1, "byteLength", 2 * CORNERS, "extensions", "EXT_meshopt_compression", of);
	} else
		view = view_of(p, corner, sizeof corner);
	add(p, view, json_pack("{sisssi}", "componentType", 5123, "type", "SCALAR", "count", CORNERS));
}

/* A colour picture of 4 x 2 px, lossless WebP: red 60 x, green 20 + 200 y, blue 128, alpha 255 - 80 x. */
static const unsigned char webp[] = { 82, 73, 70, 70, 56, 0, 0, 0, 87, 69, 66, 80, 86, 80, 56, 76, 43, 0, 0, 0, 47, 3, 64, 0, 16, 63, 32, 36, 32, 140, 48, 198, 255, 100, 226, 240, 12, 160, 64, 32, 201, 159, 102, 195, 67, 31, 84, 160, 6, 21, 32, 16, 32, 99, 45, 14, 76, 57, 16, 209, 255, 112, 2, 0 };

/* The sheet's glTF. uri: of its buffer; null: it is to be the file's own chunk. sparse: the blend shape has its moved rows alone. */
static json_t *sheet(struct packed *p, bool compressed, bool sparse, const char *uri)
{
	static uint16_t x[N][4], uv[N][2];
	static int16_t by[N][4];
	static uint16_t row[N];
	static int8_t normal[N][4];
	static uint8_t rgba[N][4];
	memset(p, 0, sizeof *p);
	p->views = json_array();
	p->accessors = json_array();
	int few = 0;
	for (int i = 0; i < N; i++) {
		for (int k = 0; k < 3; k++) {
			x[i][k] = place(i, k);
			normal[i][k] = (int8_t)(k == 2 ? -127 : 0);
			rgba[i][k] = (uint8_t)(i % 256);
		}
		rgba[i][3] = 255;
		uv[i][0] = (uint16_t)(2000 * (i % ACROSS));
		uv[i][1] = (uint16_t)(3000 * (i / ACROSS));
		if (sparse && i % 11 == 0)
			continue;
		row[few] = (uint16_t)i;
		for (int k = 0; k < 3; k++)
			by[few][k] = moved(i, k);
		few++;
	}
	add_rows(p, x, N, 8, 5123, "VEC3", false, compressed);
	add_rows(p, uv, N, 4, 5123, "VEC2", true, compressed);
	add_rows(p, normal, N, 4, 5120, "VEC3", true, compressed);
	add_corners(p, compressed);
	if (sparse) {
		json_array_append_new(p->views, view_of(p, row, (size_t)few * 2));
		json_array_append_new(p->views, view_of(p, by, (size_t)few * 8));
		json_object_set_new(json_array_get(p->views, json_array_size(p->views) - 1), "byteStride", json_integer(8));
		json_array_append_new(p->accessors, json_pack("{sisssis{sis{sisi}s{si}}}", "componentType", 5122, "type", "VEC3", "count", N, "sparse", "count", few, "indices", "bufferView",
		                                              4, "componentType", 5123, "values", "bufferView", 5));
	} else
		add_rows(p, by, N, 8, 5122, "VEC3", false, compressed);
	add_rows(p, rgba, N, 4, 5121, "VEC4", true, compressed);
	json_t *picture = view_of(p, webp, sizeof webp);
	json_array_append_new(p->views, picture);
	json_t *root = json_pack("{s{ss}s[sss]si}", "asset", "version", "2.0", "extensionsRequired", "KHR_mesh_quantization", "KHR_texture_transform", "EXT_texture_webp", "scene", 0);
	json_object_set_new(root, "scenes", json_pack("[{s[i]}]", "nodes", 0));
	json_object_set_new(root, "nodes", json_pack("[{sis[fff]s[fff]}]", "mesh", 0, "scale", size, size, size, "translation", away[0], away[1], away[2]));
	json_object_set_new(root, "meshes", json_pack("[{sss[{s{sisisisi}s[{si}]sisi}]s{s[s]}}]", "name", "Sheet", "primitives", "attributes", "POSITION", 0, "TEXCOORD_0", 1, "NORMAL", 2,
	                                              "COLOR_0", 5, "targets", "POSITION", 4, "indices", 3, "material", 0, "extras", "targetNames", "jawOpen"));
	json_object_set_new(root, "materials", json_pack("[{s{s{sis{s{s[ff]sfs[ff]}}}}}]", "pbrMetallicRoughness", "baseColorTexture", "index", 0, "extensions", "KHR_texture_transform",
	                                                 "offset", 0.25, 0.125, "rotation", M_PI / 2, "scale", 0.5, 2.0));
	json_object_set_new(root, "textures", json_pack("[{s{s{si}}}]", "extensions", "EXT_texture_webp", "source", 0));
	json_object_set_new(root, "images", json_pack("[{siss}]", "bufferView", (int)json_array_size(p->views) - 1, "mimeType", "image/webp"));
	json_object_set_new(root, "bufferViews", p->views);
	json_object_set_new(root, "accessors", p->accessors);
	json_t *buffer = json_pack("{sI}", "byteLength", (json_int_t)p->n), *nothing = json_pack("{sis{s{sb}}}", "byteLength", 1 << 20, "extensions", "EXT_meshopt_compression", "fallback", 1);
	if (uri)
		json_object_set_new(buffer, "uri", json_string(uri));
	json_object_set_new(root, "buffers", compressed ? json_pack("[oo]", buffer, nothing) : json_pack("[o]", buffer));
	if (!compressed)
		json_decref(nothing);
	return root;
}

static void write_glb(const char *name, json_t *root, const struct packed *p)
{
	char *text = json_dumps(root, JSON_COMPACT);
	const uint32_t length = (uint32_t)(strlen(text) + 3) & ~3u, bin = (uint32_t)p->n, head[5] = { 0x46546c67, 2, 28 + length + bin, length, 0x4e4f534a }, chunk[2] = { bin, 0x004e4942 };
	char *out = calloc(head[2], 1);
	memcpy(out, head, 20);
	memset(out + 20, ' ', length);
	memcpy(out + 20, text, strlen(text));
	memcpy(out + 20 + length, chunk, 8);
	memcpy(out + 28 + length, p->data, bin);
	struct err err = { 0 };
	assert_true(file_write(scratch_path("%s", name), out, head[2], &err));
	free(out);
	free(text);
}

static void check_sheet(const char *name)
{
	struct mesh mesh;
	struct look look;
	struct err err = { 0 };
	if (!character_import(&mesh, &look, scratch_path("."), name, &limits, &err))
		fail_msg("%s", err.msg);
	assert_int_equal(mesh.n_vertices, N);
	assert_int_equal(mesh.n_faces, CORNERS / 3);
	for (int i = 0; i < N; i++) {
		int at = -1;
		for (int k = 0; k < N; k++) {
			double off = 0;
			for (int d = 0; d < 3; d++)
				off = fmax(off, fabs((double)mesh.vertices[k][d] - away[d] - size * place(i, d)));
			at = off < 1e-5 ? k : at;
		}
		assert_true(at >= 0);
		double uv[2];
		turn(uv, i);
		for (int w = 0; w < look.n_wedges; w++)
			if (look.point[w] == at) {
				NEAR(look.uv[w][0], uv[0], 1e-5);
				NEAR(look.uv[w][1], uv[1], 1e-5);
				NEAR(look.normal[w][2], -1, 1e-6);
				NEAR(look.rgba[w][1] * (look.rgba[w][1] > 1 ? 1 / 255.f : 1), (i % 256) / 255., 0.003);
			}
		double by[3] = { 0 };
		for (int k = look.shape_start[0]; k < look.shape_start[1]; k++)
			for (int d = 0; d < 3 && look.shape_point[k] == at; d++)
				by[d] = (double)look.shape_by[k][d];
		for (int d = 0; d < 3; d++)
			NEAR(by[d], size * moved(i, d), 1e-5);
	}
	assert_int_equal(look.n_shapes, 1);
	assert_string_equal(look.shape[0], "jawOpen");
	assert_int_equal(look.n_textures, 1);
	assert_true(look.texture[0].png);
	int width, height;
	uint8_t *px = look_texture_pixels(&width, &height, &look.texture[0], 64, &err);
	assert_non_null(px);
	for (int y = 0; y < 2; y++)
		for (int x = 0; x < 4; x++)
			assert_memory_equal(px + 4 * (4 * y + x), ((uint8_t[4]){ (uint8_t)(60 * x), (uint8_t)(20 + 200 * y), 128, (uint8_t)(255 - 80 * x) }), 4);
	free(px);
	mesh_free(&mesh);
	look_free(&look);
}

static void what_was_packed_comes_out(void **state)
{
	(void)state;
	static struct packed p;
	for (int k = 0; k < 4; k++) {
		json_t *root = sheet(&p, k & 1, k & 2, 0);
		write_glb("sheet.glb", root, &p);
		json_decref(root);
		check_sheet("sheet.glb");
	}
}

/* A .gltf whose bytes are in a file beside it, its name with a per cent sign, and in the text itself. */
static void buffers_may_be_elsewhere(void **state)
{
	(void)state;
	static struct packed p;
	struct err err = { 0 };
	json_t *root = sheet(&p, true, false, "a%20sheet.bin");
	assert_true(file_write(scratch_path("a sheet.bin"), p.data, p.n, &err));
	assert_int_equal(json_dump_file(root, scratch_path("sheet.gltf"), 0), 0);
	check_sheet("sheet.gltf");
	static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
	static char uri[1 << 17] = "data:application/octet-stream;base64,";
	size_t at = strlen(uri);
	for (size_t i = 0; i < p.n; i += 3) {
		unsigned char b[3] = { 0 };
		memcpy(b, p.data + i, p.n - i < 3 ? p.n - i : 3);
		const unsigned word = (unsigned)b[0] << 16 | (unsigned)b[1] << 8 | b[2];
		for (int k = 0; k < 4; k++)
			uri[at++] = i + (size_t)k > p.n ? '=' : digits[word >> (18 - 6 * k) & 63];
	}
	uri[at] = 0;
	json_object_set_new(json_array_get(json_object_get(root, "buffers"), 0), "uri", json_string(uri));
	assert_int_equal(json_dump_file(root, scratch_path("sheet.gltf"), 0), 0);
	check_sheet("sheet.gltf");
	json_decref(root);
}

/* A texture that is KTX alone is left out, and one line names it and says what to do; the surface stays, compressed or not. Where a picture that is read stands beside it,
 * that one is taken without a word. */
static void ktx_is_named(void **state)
{
	static const unsigned char ktx[80] = { 0xab, 'K', 'T', 'X', ' ', '2', '0', 0xbb, '\r', '\n', 0x1a, '\n' };
	(void)state;
	static struct packed p;
	struct err err = { 0 };
	for (int k = 0; k < 4; k++) {
		const bool compressed = k & 1, beside = k & 2;
		json_t *root = sheet(&p, compressed, false, 0);
		json_array_append_new(p.views, view_of(&p, ktx, sizeof ktx));
		json_array_append_new(json_object_get(root, "images"), json_pack("{siss}", "bufferView", (int)json_array_size(p.views) - 1, "mimeType", "image/ktx2"));
		json_object_set_new(json_array_get(json_object_get(root, "buffers"), 0), "byteLength", json_integer((json_int_t)p.n));
		json_object_set_new(root, "textures", beside ? json_pack("[{s{s{si}s{si}}}]", "extensions", "KHR_texture_basisu", "source", 1, "EXT_texture_webp", "source", 0)
		                                             : json_pack("[{s{s{si}}}]", "extensions", "KHR_texture_basisu", "source", 1));
		json_array_append_new(json_object_get(root, "extensionsRequired"), json_string("KHR_texture_basisu"));
		write_glb("sheet.glb", root, &p);
		json_decref(root);
		if (beside) {
			check_sheet("sheet.glb");
			continue;
		}
		struct mesh mesh;
		struct look look;
		if (!character_import(&mesh, &look, scratch_path("."), "sheet.glb", &limits, &err))
			fail_msg("%s", err.msg);
		assert_int_equal(mesh.n_vertices, N);
		assert_true(look.has_uv);
		assert_int_equal(look.n_textures, 0);
		assert_int_equal(look.n_left_out, 1);
		assert_non_null(strstr(look.left_out[0], "is a KTX texture: save it as PNG or JPEG"));
		assert_null(strchr(look.left_out[0], '\n'));
		mesh_free(&mesh);
		look_free(&look);
	}
}

/* A refused file: one line that has the words. */
static void refused(const char *words)
{
	struct mesh mesh;
	struct look look;
	struct err err = { 0 };
	assert_false(character_import(&mesh, &look, scratch_path("."), "sheet.glb", &limits, &err));
	if (!strstr(err.msg, words) || strchr(err.msg, '\n'))
		fail_msg("%s, should say: %s", err.msg, words);
}

static void damage_is_said(void **state)
{
	(void)state;
	static struct packed p;
	static const struct { const char *list; int item; const char *key; json_int_t to; const char *words; } wrongs[] = {
		{ "bufferViews", 0, "count", 1000000, "bufferViews[0]: damaged" },
		{ "bufferViews", 0, "count", -1, "bufferViews[0]: compressed without a count" },
		{ "bufferViews", 0, "byteStride", 300, "bufferViews[0]: compressed without a count or a byteStride" },
		{ "bufferViews", 0, "byteStride", 6, "bufferViews[0]: damaged" },
		{ "bufferViews", 0, "byteOffset", 1 << 20, "bufferViews[0] ends behind its buffer" },
		{ "bufferViews", 1, "buffer", 1, "buffers[1] has no bytes" },
		{ "bufferViews", 1, "buffer", 7, "buffers[7] is not there" },
		{ "bufferViews", 2, "count", 2000000000, "more than 1024 MiB" },
		{ "bufferViews", 3, "count", CORNERS + 1, "bufferViews[3]: damaged" },
		{ "accessors", 0, "count", N + 1, "accessors[0] ends behind its bufferView" },
		{ "accessors", 1, "bufferView", 99, "accessors[1]: no such bufferView" },
		{ "accessors", 4, "componentType", 5124, "accessors[4]: neither floats nor whole numbers" },
		{ "accessors", 4, "byteOffset", 1 << 30, "accessors[4] ends behind its bufferView" },
	};
	for (int w = 0; w < COUNT(wrongs); w++) {
		json_t *root = sheet(&p, true, false, 0), *item = json_array_get(json_object_get(root, wrongs[w].list), (size_t)wrongs[w].item);
		json_t *packed = json_object_get(json_object_get(item, "extensions"), "EXT_meshopt_compression");
		json_object_set_new(packed ? packed : item, wrongs[w].key, json_integer(wrongs[w].to));
		write_glb("sheet.glb", root, &p);
		json_decref(root);
		refused(wrongs[w].words);
	}
	json_t *root = sheet(&p, false, true, 0);
	uint16_t row = N;
	const json_t *rows = json_array_get(json_object_get(root, "bufferViews"), 4);
	memcpy(p.data + json_integer_value(json_object_get(rows, "byteOffset")), &row, 2);
	write_glb("sheet.glb", root, &p);
	json_decref(root);
	refused("accessors[4]: sparse element 408 of 408");
}

/* Any byte of what is packed may be anything: read or refused in one line, never more. */
static void any_byte_may_be_wrong(void **state)
{
	(void)state;
	static struct packed p;
	uint32_t seed = 7;
	for (int i = 0; i < (SANITISED ? 60 : 400); i++) {
		json_t *root = sheet(&p, true, i % 2, 0);
		for (int k = 0; k < 3; k++) {
			seed = seed * 1664525 + 1013904223;
			p.data[seed % p.n] = (char)(seed >> 24);
		}
		write_glb("sheet.glb", root, &p);
		json_decref(root);
		struct mesh mesh;
		struct look look;
		struct err err = { 0 };
		if (!character_import(&mesh, &look, scratch_path("."), "sheet.glb", &limits, &err) && (strchr(err.msg, '\n') || strstr(err.msg, "signal")))
			fail_msg("%s", err.msg);
		mesh_free(&mesh);
		look_free(&look);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		SCRATCH_TEST(what_was_packed_comes_out),
		SCRATCH_TEST(buffers_may_be_elsewhere),
		SCRATCH_TEST(ktx_is_named),
		SCRATCH_TEST(damage_is_said),
		SCRATCH_TEST(any_byte_may_be_wrong),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
