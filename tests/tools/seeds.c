/* seeds: small valid files of every kind that the fuzz targets begin from.
 *
 *     seeds DIR        DIR/photo/..., DIR/exr/..., DIR/conf/..., DIR/front/..., DIR/fit/..., DIR/mesh/..., DIR/npy/..., DIR/csv/..., DIR/json/...,
 *                      DIR/character/...
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/npy/npy.h"
#include "image/exr.h"
#include "optics/camera_rig.h"
#include "sfm/colmap/colmap.h"
#include "tests/lib/variants/variant.h"

static const char *const stems[] = { "cameras", "images", "points3D" };

static void put(const char *dir, const char *name, const void *data, size_t size)
{
	struct err err = { 0 };
	char *path = mem_printf("%s/%s", dir, name);
	if (!file_write(path, data, size, &err)) {
		fprintf(stderr, "seeds: %s\n", err.msg);
		exit(1);
	}
	free(path);
}

static void put_blob(const char *dir, const char *name, struct blob b)
{
	put(dir, name, b.data, b.size);
	free(b.data);
}

static void put_text(const char *dir, const char *name, const char *text)
{
	put(dir, name, text, strlen(text));
}

static void photos(const char *dir)
{
	struct pixels p = pattern(24, 20, 3), g = pattern(24, 20, 1), q = pattern(24, 20, 4);
	struct blob jpeg = encode_jpeg(&p, 0);
	put_blob(dir, "photo/exif.jpg", with_exif(jpeg, &(struct exif_block){ 6, 100, 150, 250, 24, 20 }));
	put_blob(dir, "photo/plain.jpg", jpeg);
	put_blob(dir, "photo/grey.jpg", encode_jpeg(&g, 0));
	put_blob(dir, "photo/8.png", encode_png(&p, 8));
	put_blob(dir, "photo/16.png", encode_png(&q, 16));
	put_blob(dir, "photo/8.tif", encode_tiff(&p, 8, AS_LZW, 3));
	put_blob(dir, "photo/16.tif", encode_tiff(&q, 16, AS_TILED | AS_BIG_ENDIAN, 1));
	put_blob(dir, "photo/planar.tif", encode_tiff(&p, 16, AS_PLANAR, 1));
	pixels_free(&p);
	pixels_free(&g);
	pixels_free(&q);
}

static void maps(const char *dir)
{
	static const char *const rgb[] = { "R", "G", "B" }, *const y[] = { "Y" };
	struct image colour = image_new(20, 18, 3), grey = image_new(33, 40, 1);
	struct exr_info info = { 6.4, "{}" };
	struct err err = { 0 };
	char *a = mem_printf("%s/exr/rgb.exr", dir), *b = mem_printf("%s/exr/y.exr", dir),
	     *c = mem_printf("%s/photo/rgb.exr", dir);
	for (int i = 0; i < 20 * 18 * 3; i++)
		colour.px[i] = (float)(i % 7) / 7;
	for (int i = 0; i < 33 * 40; i++)
		grey.px[i] = (float)(i % 11);
	if (!exr_write(a, &colour, rgb, EXR_HALF, &info, &err) || !exr_write(b, &grey, y, EXR_FLOAT, &info, &err)
	    || !exr_write(c, &colour, rgb, EXR_HALF, 0, &err))
		fprintf(stderr, "seeds: %s\n", err.msg);
	free(a);
	free(b);
	free(c);
	image_free(&colour);
	image_free(&grey);
}

static void arrays(const char *dir)
{
	struct err err = { 0 };
	double x[12] = { 0, 1, 2 };
	struct npy a = npy_of(NPY_F8, 2, (long[]){ 6, 2 }, x), b = npy_of(NPY_U1, 3, (long[]){ 2, 3, 4 }, x);
	char *paths[] = { mem_printf("%s/npy/a.npy", dir), mem_printf("%s/npy/b.npy", dir), mem_printf("%s/npy/c.npz", dir) };
	if (!npy_save(paths[0], &a, &err) || !npy_save(paths[1], &b, &err)
	    || !npz_save(paths[2], 2, (struct npz_item[]){ { "x", a }, { "y", b } }, "{}", &err))
		fprintf(stderr, "seeds: %s\n", err.msg);
	for (int i = 0; i < 3; i++)
		free(paths[i]);
	put_text(dir, "npy/swapped.npy", "\x93NUMPY\2");
	put_text(dir, "csv/a.csv", "frame,time_s,\"g1_deg\"\n0,0,1.5\n1,0.0167,\n# x\n2,0.03,-1e-3\n");
	put_text(dir, "csv/b.csv", "\xef\xbb\xbf" "a;b\r\n1;\r\n;2\r\n");
}

/* One camera, two images, one point: text and binary behind the five bytes that say where the files end. */
static void models(const char *dir)
{
	static const char cameras[] = "1 PINHOLE 100 80 90 90 50 40\n",
	                  images[] = "1 1 0 0 0 0 0 0 1 a.jpg\n10 10 1\n2 1 0 0 0 1 0 0 1 b.jpg\n20 10 1\n",
	                  points[] = "1 0 0 5 1 2 3 -1 1 0 2 0\n";
	const char *const data[] = { cameras, images, points };
	const size_t size[] = { sizeof cameras - 1, sizeof images - 1, sizeof points - 1 };
	struct colmap_model model;
	struct err err = { 0 };
	if (!colmap_parse(&model, COLMAP_TEXT, data, size, data, &err))
		fprintf(stderr, "seeds: %s\n", err.msg);
	for (int text = 0; text < 2; text++) {
		char *files[3], *all = 0, *to = mem_printf("%s/colmap-%d", dir, text);
		size_t sizes[3], n = 0;
		if (!colmap_save(&model, to, text ? COLMAP_TEXT : COLMAP_BINARY, &err))
			fprintf(stderr, "seeds: %s\n", err.msg);
		FILE *f = open_memstream(&all, &n);
		for (int i = 0; i < 3; i++) {
			char *path = mem_printf("%s/%s.%s", to, stems[i], text ? "txt" : "bin");
			if (!file_read(&files[i], &sizes[i], path, 1 << 16, &err))
				exit(1);
			free(path);
		}
		fprintf(f, "%c%c%c%c%c", text, (int)(sizes[0] & 255), (int)(sizes[0] >> 8), (int)(sizes[1] & 255), (int)(sizes[1] >> 8));
		for (int i = 0; i < 3; i++) {
			fwrite(files[i], 1, sizes[i], f);
			free(files[i]);
		}
		fclose(f);
		put(dir, text ? "colmap/text" : "colmap/binary", all, n);
		free(all);
		free(to);
	}
	colmap_free(&model);
}

/* One a reader: the byte before the text says which. */
static void objects(const char *dir)
{
	static const char eye[] = "{\"abl\":{\"melanin\":0.1,\"eumelanin_ratio\":0.5,\"thickness_mm\":0.05},\"stroma\":{\"melanin\":0.01,"
		"\"eumelanin_ratio\":0.5,\"thickness_scale\":1},\"exposure\":1,\"illuminant\":\"D65\",\"scattering\":\"single\",\"white_red\":"
		"{\"value\":1},\"white_blue\":{\"value\":1},\"veil\":{\"value\":0},\"white\":{\"rgb\":[1,1,1]},\"cos_view\":1,\"cos_light\":1,\"bands\":4}";
	char program[33], *text = 0;
	struct camera_rig rig = { .cameras = mem_new(1, sizeof *rig.cameras), .n = 1, .scale_sigma = NAN, .scale_source = "assumed",
		.frame_source = "cameras" };
	struct err err = { 0 };
	rig.cameras[0] = (struct rig_camera){ .name = mem_str("a"), .file = mem_str("views/a.jpg"), .frame = -1, .width = 80, .height = 60,
		.camera = { .focal_px = 90, .source = CAMERA_RIG }, .focal = { 90, 90 }, .has_pose = true, .residual_px = 0.5, .points = 9 };
	for (int k = 0; k < 4; k++)
		rig.cameras[0].cam_from_head[k][k] = 1;
	char *path = mem_printf("%s/json-rig", dir);
	size_t size;
	if (!camera_rig_save(&rig, path, 0, 0, &err) || !file_read(&text, &size, path, 1 << 16, &err))
		fprintf(stderr, "seeds: %s\n", err.msg);
	char *all = mem_printf("%c%s", 7, text ? text : "");
	put_text(dir, "json/rig", all);
	free(all);
	free(text);
	free(path);
	camera_rig_free(&rig);
	all = mem_printf("%c%s", 2, eye);
	put_text(dir, "json/pigment", all);
	free(all);
	put_text(dir, "json/pupil", "\3{\"pupil\":{\"cx\":0.1,\"cy\":0,\"r\":1.9}}");
	put_text(dir, "json/folds", "\4{\"chart\":[0,0,10,10],\"px_per_mm\":2,\"expressions\":[{\"name\":\"brows_up\",\"lines\":[[1,2]]}]}");
	put_text(dir, "json/model", "\5{\"inputs\":[\"g1_deg\",\"g2_deg\",\"g3_deg\",\"g4_px\",\"g5_px\"],\"points_per_lid\":2,\"vertices\":3,"
	                            "\"lid_components\":1,\"skin_components\":1,\"reference_frame\":0,\"camera\":{}}");
	file_hash_bytes(program, "1", 1);
	all = mem_printf("%c{\"complete\":true,\"program\":\"%s\",\"config\":{\"blur.sigma\":\"3\"},\"each\":[\"view.*.mm\"],\"lists\":{\"photos\":\"0\"},"
	                 "\"outputs\":{\"model.json\":{\"hash\":\"0\",\"inputs\":{\"photos/a.jpg\":\"0\"}}}}", 6, program);
	put_text(dir, "json/record", all);
	free(all);
}

/* The letter before each says what it is (tests/fuzz/fuzz_character.c). */
static void characters(const char *dir)
{
	struct pixels p = pattern(24, 20, 4);
	struct blob png = encode_png(&p, 8), jpeg = encode_jpeg(&p, 0), of[2] = { png, jpeg };
	for (int i = 0; i < 2; i++) {
		char *all = mem_array(of[i].size + 1, 1);
		all[0] = 't';
		memcpy(all + 1, of[i].data, of[i].size);
		put(dir, i ? "character/texture.jpg" : "character/texture.png", all, of[i].size + 1);
		free(all);
		free(of[i].data);
	}
	pixels_free(&p);
	put_text(dir, "character/quad.obj", "ov 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\nf 1/1 2/2 3/1 4/2\n");
	put_text(dir, "character/three.gltf", "g{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"scale\":[2,2,2]}],"
	                                      "\"materials\":[{\"name\":\"m\",\"alphaMode\":\"MASK\"}],\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"material\":0,"
	                                      "\"targets\":[{\"POSITION\":0}]}]}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
	                                      "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"buffers\":[{\"byteLength\":36,\"uri\":\"data:application/octet-stream;base64,"
	                                      "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA\"}]}");
	put_text(dir, "character/packed.gltf", "g{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],\"images\":[{\"uri\":\"x.webp\"}],\"textures\":[{\"extensions\":{\"EXT_texture_webp\":{\"source\":0}}}],"
	                                       "\"materials\":[{\"normalTexture\":{\"index\":0,\"extensions\":{\"KHR_texture_transform\":{\"scale\":[2,2],\"rotation\":1}}}}],"
	                                       "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":2},\"indices\":1,\"material\":0,\"targets\":[{\"POSITION\":3}]}]}],"
	                                       "\"accessors\":[{\"bufferView\":0,\"componentType\":5123,\"normalized\":true,\"count\":3,\"type\":\"VEC3\"},"
	                                       "{\"bufferView\":1,\"componentType\":5125,\"count\":3,\"type\":\"SCALAR\"},{\"bufferView\":0,\"componentType\":5123,\"normalized\":true,\"count\":3,\"type\":\"VEC2\"},"
	                                       "{\"componentType\":5122,\"count\":3,\"type\":\"VEC3\",\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":1,\"componentType\":5125},\"values\":{\"bufferView\":0}}}],"
	                                       "\"bufferViews\":[{\"buffer\":1,\"byteLength\":24,\"byteStride\":8,\"extensions\":{\"EXT_meshopt_compression\":{\"buffer\":0,\"byteLength\":57,\"byteStride\":8,\"mode\":\"ATTRIBUTES\",\"count\":3}}},"
	                                       "{\"buffer\":1,\"byteLength\":12,\"extensions\":{\"EXT_meshopt_compression\":{\"buffer\":0,\"byteOffset\":57,\"byteLength\":18,\"byteStride\":4,\"mode\":\"TRIANGLES\",\"count\":3}}}],"
	                                       "\"buffers\":[{\"byteLength\":75,\"uri\":\"data:application/octet-stream;base64,"
	                                       "oAEYAAAAARgAAAABBAAAAAEEAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA4PAAdodWZ3iphmWJaJgBaQAA\"},{\"byteLength\":36}]}");
	put_text(dir, "character/words.fbx", "f; FBX 7.4.0 project file\nFBXHeaderExtension:  {\nFBXVersion: 7400\n}\nObjects:  {\nGeometry: 1, \"Geometry::q\", \"Mesh\" {\nVertices: *9 {\n"
	                                     "a: 0,0,0,1,0,0,0,1,0\n}\nPolygonVertexIndex: *3 {\na: 0,1,-3\n}\n}\nModel: 2, \"Model::q\", \"Mesh\" {\n}\n}\nConnections:  {\nC: \"OO\",2,0\nC: \"OO\",1,2\n}\n");
	put_text(dir, "character/scene", "s2Two parts of one node, of many vertices: whatever numbers these letters are, and those that follow them 0123456789");
	char none[1 + 16 * 40] = "r";
	put(dir, "character/result", none, sizeof none);
}

int main(int argc, char **argv)
{
	if (argc != 2)
		return 2;
	const char *dir = argv[1];
	characters(dir);
	photos(dir);
	maps(dir);
	models(dir);
	arrays(dir);
	objects(dir);
	put_text(dir, "conf/a.conf", "; comment\ns.a = 0.25\ns.b = 3\ns.c = yes\ns.d = green\ns.e = 0 0.5 1\ns.f = x y\nphoto.n.g = 0 1\n");
	put_text(dir, "front/error.conf", "; made\nblur.fast = 0.4 mm, 0.1 s + 0.1 s/Mpx: sigma = 4, steps = 2\nblur.fine = 0.01 mm, 1 s + 1 s/Mpx: sigma = 1\n"
	                                  "\ferror = 0.05 mm\n");
	put_text(dir, "front/time.conf", "blur.fast = 0.4 mm, 0.1 s + 0.1 s/Mpx: sigma = 4\npaint.fine = 1 %, 1 s + 0 s/Mpx: rays = 8\n\ftime = 2 s\n");
	put_text(dir, "fit/a.json",
	         "{\"status\":\"ok\",\"reason\":\"\",\"ellipse\":{\"cx\":8,\"cy\":6,\"a\":5,\"b\":4,\"angle_deg\":10},\"pupil\":null,"
	         "\"theta_deg\":10,\"phi_deg\":20,\"theta_sigma_deg\":1,\"cam_from_eye\":[1,0,0,0,0,1,0,0,0,0,1,120,0,0,0,1],"
	         "\"coverage\":0.5,\"rms_px\":0.3,\"width\":1600,\"height\":1200,\"camera\":{\"focal_px\":10000,"
	         "\"center_px\":[800,600],\"distortion\":[0,0,0,0,0],\"source\":\"exif\"}}");
	put_text(dir, "mesh/a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvn 0 0 1\nvt 0 0\nf 1/1/1 2/1/1 3/1/1 4/1/1\nf 1 2 3\n");
	put_text(dir, "mesh/a.ply", "ply\nformat ascii 1.0\ncomment x\nelement vertex 3\nproperty float x\nproperty float y\n"
	                            "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
	                            "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
	                            "0 0 0 1 2 3\n1 0 0 1 2 3\n0 1 0 1 2 3\n3 0 1 2\n");
	static const char binary[] = "ply\nformat binary_little_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
	                             "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
	                             "\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\x3f\0\0\0\0\0\0\0\0\0\0\0\0\0\0\x80\x3f\0\0\0\0"
	                             "\3\0\0\0\0\1\0\0\0\2\0\0\0";
	put(dir, "mesh/b.ply", binary, sizeof binary - 1);
	return 0;
}
