/* made_face DIR: the made face of tests/lib/scenes/face.h as a capture folder in which track, train and transfer have run: what
 * extrapolate and render start from. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/npy/npy.h"
#include "bridge/om_mesh.h"
#include "image/exr.h"
#include "image/video/video.h"
#include "tests/lib/scenes/face.h"

enum { FRAMES = 12, W = 160, H = 90 };
static const char *root;

static const char *at(const char *rel)
{
	static char path[4][1024];
	static int turn;
	char *p = path[turn = (turn + 1) % 4];
	snprintf(p, sizeof path[0], "%s/%s", root, rel);
	return p;
}

static bool write_obj(const struct mesh *mesh, struct err *err)
{
	char *text = 0;
	size_t size = 0;
	FILE *out = open_memstream(&text, &size);
	for (int i = 0; i < mesh->n_vertices; i++)  // centimetres, to see units through
		fprintf(out, "v %.6f %.6f %.6f\n", (double)mesh->vertices[i][0] / 10, (double)mesh->vertices[i][1] / 10, (double)mesh->vertices[i][2] / 10);
	for (int f = 0; f < mesh->n_faces; f++)
		fprintf(out, "f %d %d %d\n", mesh->faces[f][0] + 1, mesh->faces[f][1] + 1, mesh->faces[f][2] + 1);
	fclose(out);
	bool ok = file_write(at("targets/made.obj"), text, size, err);
	free(text);
	return ok;
}

static bool write_transfer(const struct face *face, struct err *err)
{
	int n = face->character.n_vertices, entries = face->b_start[n];
	float *sure = mem_new((size_t)n, sizeof *sure);
	for (int i = 0; i < n; i++)
		sure[i] = 1;
	const struct npz_item items[] = { { "indptr", npy_of(NPY_I4, 1, (long[]){ n + 1 }, face->b_start) },
		                              { "indices", npy_of(NPY_I4, 1, (long[]){ entries }, face->b_column) },
		                              { "data", npy_of(NPY_F8, 1, (long[]){ entries }, face->b_weight) },
		                              { "confidence", npy_of(NPY_F4, 1, (long[]){ n }, sure) } };
	json_t *json = json_object();
	double same[16] = { 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1 };
	json_object_set_new(json, "subject_from_target", json_numbers(16, same));
	json_object_set_new(json, "target_unit_mm", json_real(10));
	json_object_set_new(json, "subject_unit_mm", json_real(1));
	bool ok = npz_save(at("work/targets/made/barycentric.npz"), COUNT(items), items, 0, err)
	          && json_write(at("work/targets/made/registration.json"), json, 0, err)
	          && om_mesh_save(&face->character, at("work/targets/made/registered.ply"), "{}", err);
	json_decref(json);
	free(sure);
	return ok;
}

/* The brow's expression folds the skin above both eyes in one line: a groove a millimetre wide. */
static bool write_wrinkles(const struct face *face, struct err *err)
{
	enum { CHART_W = 960, CHART_H = 120 };
	static const char *const channels[] = { "brow.height", "brow.open" };
	const struct skin_camera *camera = &face->model.camera;
	double px_per_mm = camera->focal_px / camera->cam_from_head[2][3];
	int x0 = (int)camera->center_px[0] - CHART_W / 2, y0 = (int)(camera->center_px[1] - 20 * px_per_mm) - CHART_H / 2;
	struct image map = image_new(CHART_W, CHART_H, 2);
	for (int y = 0; y < CHART_H; y++)
		for (int x = 0; x < CHART_W; x++) {
			double off = (y - CHART_H / 2.0) / px_per_mm, deep = exp(-off * off / 0.5) * (x > 20 && x < CHART_W - 20);
			map.px[2 * (y * CHART_W + x)] = (float)(-0.5 * deep);
			map.px[2 * (y * CHART_W + x) + 1] = (float)(1 - 0.4 * deep);
		}
	json_t *json = json_pack("{s:[i,i,i,i],s:f,s:[{s:s,s:[i]}]}", "chart", x0, y0, CHART_W, CHART_H, "px_per_mm", px_per_mm, "expressions", "name", "brow", "lines", 1);
	bool ok = json_write(at("work/skin/wrinkles.json"), json, 0, err) && exr_write(at("work/skin/wrinkles.exr"), &map, channels, EXR_FLOAT, 0, err);
	json_decref(json);
	image_free(&map);
	return ok;
}

/* A gaze that wanders, and a blink that hides it. */
static bool write_gaze(struct err *err)
{
	static const char *const names[] = { "frame", "time_s", "g1_deg", "g2_deg", "g3_deg", "g4_px", "g5_px", "g6_deg", "g7_deg",
		                                 "g8_deg", "g9_px", "g10_px", "au1", "au2" };
	struct csv_table t = csv_table_new(COUNT(names), names);
	for (int f = 0; f < FRAMES; f++) {
		double h = f == 6 ? NAN : 12 * sin(f / 2.0), v = f == 6 ? NAN : 6 * cos(f / 3.0), open = f == 6 ? -60 : 0;
		csv_add(&t, (double[]){ f, f / 30.0, h, v, 0, open, 1, h, v, 0, open, 1, 0, 0 });
	}
	bool ok = csv_save(at("work/skin/gaze.csv"), &t, err);
	csv_table_free(&t);
	return ok;
}

static bool write_video(struct err *err)
{
	struct video_writer_conf conf = { .width = W, .height = H, .fps = 30, .crf = 20 };
	uint8_t *rgb = mem_new(W * H, 3);
	struct video_writer *writer = file_mkdirs(at("video"), err) ? video_writer_open(at("video/made.mp4"), &conf, err) : 0;
	bool ok = writer;
	for (int f = 0; f < FRAMES && ok; f++) {
		memset(rgb, 60 + 10 * f, W * H * 3);
		ok = video_writer_put(writer, rgb, f / 30.0, err);
	}
	free(rgb);
	return video_writer_close(writer, ok, err) && ok;
}

int main(int argc, char **argv)
{
	struct face face;
	struct err err = { 0 };
	if (argc != 2)
		return 2;
	root = argv[1];
	static const char conf[] = "quality = draft\nsubject.eye_radius = 12\nsubject.eye_center.left = 31 0 0\nsubject.eye_center.right = -31 0 0\n";
	face_make(&face, false);
	bool ok = file_mkdirs(at("work/skin"), &err) && file_mkdirs(at("work/targets/made"), &err)
	          && file_write(at("capture.conf"), conf, sizeof conf - 1, &err) && write_obj(&face.character, &err)
	          && skin_model_save(&face.model, at("work/skin"), "{}", &err) && write_transfer(&face, &err) && write_gaze(&err) && write_wrinkles(&face, &err)
	          && write_video(&err);
	face_free(&face);
	if (!ok)
		fprintf(stderr, "made_face: %s\n", err.msg);
	return ok ? 0 : 1;
}
