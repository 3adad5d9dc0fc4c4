#include "rig/glb/skin.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/version.h"

static const double metres = 1e-3;

/* An eyeball from its globe map, in the globe's own frame (the head's axes), with vertex colours: sclera, iris, pupil. */
static json_t *eye_mesh(struct glb_buffer *g, const struct rig *rig, int side, const struct glb_conf *conf, int material)
{
	enum { AROUND = 64, RINGS = 80, N = AROUND * (RINGS + 1) };
	float *x = mem_new(3 * N, sizeof *x), *nrm = mem_new(3 * N, sizeof *nrm), *rgb = mem_new(3 * N, sizeof *rgb);
	uint32_t *corner = mem_new(6 * AROUND * RINGS, sizeof *corner);
	int n = 0;
	for (int j = 0; j <= RINGS; j++)
		for (int i = 0; i < AROUND; i++) {
			// Rings crowd towards the front, where the iris is.
			double t = (double)j / RINGS, fall = M_PI * t * (0.35 + 0.65 * t), turn = 2 * M_PI * i / AROUND;
			float *p = x + 3 * (j * AROUND + i), d[3] = { (float)(sin(fall) * cos(turn)), (float)(sin(fall) * sin(turn)), (float)cos(fall) };
			double limbus = 0.5 * (1 + tanh((fall - 0.507) / 0.03)), pupil = fall < 0.15 ? 0.03 : 1;  // 5.85 mm and 1.8 mm of 12
			double streak = 0.85 + 0.3 * sin(23 * turn + 2 * sin(7 * turn)) * sin(17 * turn);
			for (int c = 0; c < 3; c++) {
				p[c] = (float)(metres * globe_map_at(&rig->globe[side].map, d)) * d[c];
				nrm[3 * (j * AROUND + i) + c] = d[c];
				rgb[3 * (j * AROUND + i) + c] = (float)(limbus * conf->sclera_rgb[c] + (1 - limbus) * conf->iris_rgb[c] * pupil * streak);
			}
		}
	for (int j = 0; j < RINGS; j++)
		for (int i = 0; i < AROUND; i++) {
			uint32_t a = (uint32_t)(j * AROUND + i), b = (uint32_t)(j * AROUND + (i + 1) % AROUND), c = a + AROUND, d = b + AROUND;
			uint32_t quad[6] = { a, c, d, a, d, b };
			for (int k = 0; k < 6; k++)
				if (!(j == 0 && k >= 3) && !(j == RINGS - 1 && k < 3))  // at the poles one of the two has no area
					corner[n++] = quad[k];
		}
	int position = glb_add_floats(g, x, N, 3, true, GLB_ARRAY), normal = glb_add_floats(g, nrm, N, 3, false, GLB_ARRAY);
	int colour = glb_add_floats(g, rgb, N, 3, false, GLB_ARRAY), view = glb_add_view(g, corner, (size_t)n * sizeof *corner, GLB_INDICES);
	int index = glb_add_accessor(g, json_pack("{s:i,s:i,s:i,s:s}", "bufferView", view, "componentType", GLB_UINT, "count", n, "type", "SCALAR"));
	free(x);
	free(nrm);
	free(rgb);
	free(corner);
	return json_pack("{s:s,s:[{s:{s:i,s:i,s:i},s:i,s:i}]}", "name", side ? "eye_right" : "eye_left", "primitives", "attributes",
	                 "POSITION", position, "NORMAL", normal, "COLOR_0", colour, "indices", index, "material", material);
}

static json_t *real3(const double x[3], double scale)
{
	return json_pack("[f,f,f]", scale * x[0], scale * x[1], scale * x[2]);
}

/* The quaternion of the root: head_from_target. */
static json_t *root_rotation(const double m[3][3])
{
	double w = 0.5 * sqrt(fmax(1 + m[0][0] + m[1][1] + m[2][2], 0)), v[4];
	if (w > 1e-3) {
		double q[4] = { (m[2][1] - m[1][2]) / (4 * w), (m[0][2] - m[2][0]) / (4 * w), (m[1][0] - m[0][1]) / (4 * w), w };
		memcpy(v, q, sizeof v);
	} else {  // half a turn about some axis
		int k = m[0][0] > m[1][1] ? m[0][0] > m[2][2] ? 0 : 2 : m[1][1] > m[2][2] ? 1 : 2;
		double s = sqrt(fmax(1 + 2 * m[k][k] - m[0][0] - m[1][1] - m[2][2], 1e-12));
		for (int i = 0; i < 3; i++)
			v[i] = i == k ? s / 2 : (m[i][k] + m[k][i]) / (2 * s);
		v[3] = 0;
	}
	double len = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + v[3] * v[3]);
	return json_pack("[f,f,f,f]", v[0] / len, v[1] / len, v[2] / len, v[3] / len);
}

/* The root, the skin's meshes, the eyes. */
static json_t *nodes(const struct rig *rig, const char *name, const struct glb_skin *skin)
{
	json_t *list = json_array(), *children = json_array();
	for (int i = 0; i < skin->n + 2; i++)
		json_array_append_new(children, json_integer(1 + i));
	json_array_append_new(list, json_pack("{s:s,s:o,s:o}", "name", name, "children", children, "rotation", root_rotation(rig->head_from_target)));
	for (int i = 0; i < skin->n; i++) {
		json_t *of = json_object_get(json_array_get(skin->meshes, (size_t)i), "name");
		json_array_append_new(list, json_pack("{s:O,s:i}", "name", of, "mesh", i));
	}
	for (int s = 0; s < 2; s++)
		json_array_append_new(list, json_pack("{s:s,s:i,s:o}", "name", s ? "eye_right" : "eye_left", "mesh", skin->n + s, "translation",
		                                      real3(rig->globe[s].center, metres)));
	return list;
}

/* Rotation q of a globe's node, target_from_globe: its mesh is in the head's axes, its node in the rig's. */
static void turn_of(float q[4], const float from_rest[4], const double head_from_target[3][3])
{
	json_t *back = root_rotation(head_from_target);  // its conjugate takes the head's axes to the rig's
	double b[4];
	for (int k = 0; k < 4; k++)
		b[k] = (k < 3 ? -1 : 1) * json_real_value(json_array_get(back, (size_t)k));
	json_decref(back);
	const float *a = from_rest;
	double r[4] = { a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1], a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
		            a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3], a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2] };
	double len = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
	for (int k = 0; k < 4; k++)
		q[k] = (float)(r[k] / len);
}

/* The weights of a skin's mesh over time: the animation's targets move, the others stay at 0. Returns the sampler. */
static int weights(struct glb_buffer *g, json_t *samplers, const struct glb_bake *b, int input, size_t n, size_t all)
{
	float *weight = mem_new(n * all + 1, sizeof *weight);
	for (size_t f = 0; f < n; f++)
		memcpy(weight + f * all, b->weight + f * (size_t)b->n_targets, (size_t)b->n_targets * sizeof *weight);
	const int output = glb_add_floats(g, weight, n * all, 1, false, 0);
	json_array_append_new(samplers, json_pack("{s:i,s:i}", "input", input, "output", output));
	free(weight);
	return (int)json_array_size(samplers) - 1;
}

static json_t *animation(struct glb_buffer *g, const struct rig *rig, const struct glb_bake *b, const struct drive *drive,
                         const struct glb_skin *skin)
{
	size_t n = (size_t)drive->n;
	float *time = mem_new(n + 1, sizeof *time), *turn = mem_new(4 * n + 1, sizeof *turn);
	for (size_t f = 0; f < n; f++)
		time[f] = (float)(drive->time[f] - drive->time[0]);
	int input = glb_add_floats(g, time, n, 1, true, 0);
	json_t *samplers = json_array(), *channels = json_array();
	for (int i = 0; i < skin->n; i++)
		if (skin->ours[i] && b->n_targets) {
			const int sampler = weights(g, samplers, b, input, n, (size_t)skin->all[i]);
			json_array_append_new(channels, json_pack("{s:i,s:{s:i,s:s}}", "sampler", sampler, "target", "node", 1 + i, "path", "weights"));
		}
	for (int s = 0; s < 2; s++) {
		for (size_t f = 0; f < n; f++)
			turn_of(turn + 4 * f, b->turn[s] + 4 * f, rig->head_from_target);
		int output = glb_add_floats(g, turn, n, 4, false, 0);
		json_array_append_new(samplers, json_pack("{s:i,s:i}", "input", input, "output", output));
		json_array_append_new(channels, json_pack("{s:i,s:{s:i,s:s}}", "sampler", (int)json_array_size(samplers) - 1, "target", "node",
		                                          1 + skin->n + s, "path", "rotation"));
	}
	free(time);
	free(turn);
	return json_pack("{s:s,s:o,s:o}", "name", "gaze", "samplers", samplers, "channels", channels);
}

bool glb_write(const char *path, struct glb_report *report, const struct rig *rig, const struct drive *drive, const char *name,
               const struct look *look, const struct glb_conf *conf, const char *made_by, struct err *err)
{
	struct glb_buffer g = { .views = json_array(), .accessors = json_array() };
	struct glb_bake bake;
	bool ok = glb_bake_make(&bake, rig, drive, conf, err);
	if (ok) {
		*report = (struct glb_report){ bake.n_targets, bake.n, bake.worst, 0 };
		json_t *asset = json_pack("{s:s,s:s}", "version", "2.0", "generator", "Eyewright " EYEWRIGHT_VERSION);
		json_t *made = made_by ? json_loads(made_by, 0, 0) : 0;
		if (made)
			json_object_set_new(asset, "extras", json_pack("{s:o}", "made_by", made));
		struct glb_skin skin;
		glb_skin_make(&skin, &g, rig, &bake, conf, look);
		for (int s = 0; s < 2; s++)
			json_array_append_new(skin.meshes, eye_mesh(&g, rig, s, conf, skin.eye_material));
		json_t *root = json_pack("{s:o,s:i,s:[{s:[i]}],s:o,s:o,s:o,s:[o]}", "asset", asset, "scene", 0, "scenes", "nodes", 0, "nodes",
		                         nodes(rig, name, &skin), "meshes", skin.meshes, "materials", skin.materials, "animations",
		                         animation(&g, rig, &bake, drive, &skin));
		if (skin.textures) {
			json_object_set_new(root, "images", skin.images);
			json_object_set_new(root, "textures", skin.textures);
		}
		glb_skin_free(&skin);
		json_object_set_new(root, "accessors", g.accessors);
		json_object_set_new(root, "bufferViews", g.views);
		json_object_set_new(root, "buffers", json_pack("[{s:I}]", "byteLength", (json_int_t)g.size));
		ok = glb_save(path, &g, root, &report->bytes, err);
		json_decref(root);
	} else {
		json_decref(g.accessors);
		json_decref(g.views);
	}
	free(g.bin);
	glb_bake_free(&bake);
	return ok;
}
