#include "rig/glb/glb.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/version.h"
#include "rig/glb/blink.h"
#include "rig/glb/graft.h"
#include "rig/glb/skin.h"
#include "rig/glb/strands.h"
#include "rig/glb/tears.h"

static const double metres = 1e-3;
static const char quantised[] = "KHR_mesh_quantization";
static const char *const eye_names[2] = { "eye_left", "eye_right" };

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

/* Rotation q of a globe's node, target_from_globe: its meshes are in the head's axes, its node in the rig's. from_rest: null: at rest. */
static void turn_of(float q[4], const float *from_rest, const double head_from_target[3][3])
{
	static const float none[4] = { 0, 0, 0, 1 };
	json_t *back = root_rotation(head_from_target);  // its conjugate takes the head's axes to the rig's
	double b[4];
	for (int k = 0; k < 4; k++)
		b[k] = (k < 3 ? -1 : 1) * json_real_value(json_array_get(back, (size_t)k));
	json_decref(back);
	const float *a = from_rest ? from_rest : none;
	double r[4] = { a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1], a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
		            a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3], a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2] };
	double len = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2] + r[3] * r[3]);
	for (int k = 0; k < 4; k++)
		q[k] = (float)(r[k] / len);
}

/* Where an eye's meshes are in the file. */
struct eye_meshes {
	int first, n;
};

/* Nodes of the eyes in `list`, whose parts follow them; an eye turns about its own origin. */
static void put_eyes(json_t *list, const struct rig *rig, const struct glb_eye eye[2], const struct eye_meshes in[2], json_t *meshes)
{
	int next = (int)json_array_size(list) + 2;
	for (int s = 0; s < 2; s++) {
		const struct rig_globe *globe = &rig->globe[s];
		const double scale = globe->radius / eye[s].radius;
		json_t *parts = json_array();
		float q[4];
		for (int i = 0; i < in[s].n; i++)
			json_array_append_new(parts, json_integer(next++));
		turn_of(q, 0, rig->head_from_target);
		json_array_append_new(list, json_pack("{s:s,s:o,s:o,s:[f,f,f,f],s:[f,f,f]}", "name", eye_names[s], "children", parts, "translation",
		                                      real3(globe->center, metres), "rotation", q[0], q[1], q[2], q[3], "scale", scale, scale, scale));
	}
	for (int s = 0; s < 2; s++)
		for (int i = 0; i < in[s].n; i++) {
			const char *part = json_string_value(json_object_get(json_array_get(meshes, (size_t)(in[s].first + i)), "name"));
			char *name = mem_printf("%s_%s", eye_names[s], part ? part : "part");
			json_array_append_new(list, json_pack("{s:s,s:i}", "name", name, "mesh", in[s].first + i));
			free(name);
		}
}

/* The root, the skin's meshes, the eyes, the eyes' parts. */
static json_t *nodes(const struct rig *rig, const struct glb_eye eye[2], const struct eye_meshes in[2], const char *name, const struct glb_skin *skin)
{
	json_t *list = json_array(), *children = json_array();
	for (int i = 0; i < skin->n + 2; i++)
		json_array_append_new(children, json_integer(1 + i));
	json_array_append_new(list, json_pack("{s:s,s:o,s:o}", "name", name, "children", children, "rotation", root_rotation(rig->head_from_target)));
	for (int i = 0; i < skin->n; i++) {
		json_t *of = json_object_get(json_array_get(skin->meshes, (size_t)i), "name");
		const double scale = metres * skin->unit;
		json_array_append_new(list, json_pack("{s:O,s:i,s:[f,f,f]}", "name", of, "mesh", i, "scale", scale, scale, scale));
	}
	put_eyes(list, rig, eye, in, skin->meshes);
	return list;
}

/* The weights of a skin's mesh over time: the animation's targets move, the others stay at 0. Returns the sampler. */
static int weights(struct glb_buffer *g, json_t *samplers, const struct glb_bake *b, int input, size_t n, size_t all,
                   const double *gain)
{
	float *weight = mem_new(n * all + 1, sizeof *weight);
	for (size_t f = 0; f < n; f++)
		memcpy(weight + f * all, b->weight + f * (size_t)b->n_targets, (size_t)b->n_targets * sizeof *weight);
	for (size_t i = 0; gain && i < n * (size_t)b->n_targets; i++) {
		const size_t k = i % (size_t)b->n_targets;
		weight[i / (size_t)b->n_targets * all + k] /= (float)fmax(gain[k], 1);
	}
	const int output = glb_add_shares(g, weight, n * all);
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
			const int sampler = weights(g, samplers, b, input, n, (size_t)skin->all[i], skin->gain[i]);
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

/* A member of the root; glTF has no empty arrays. */
static void put_some(json_t *root, const char *key, json_t *array)
{
	if (json_array_size(array))
		json_object_set(root, key, array);
}

/* The eyes' meshes and all they need; the same bytes for both sides once. */
static bool graft_eyes(struct eye_meshes in[2], struct glb_buffer *g, const struct glb_arrays *to, const struct glb_eye eye[2], struct err *err)
{
	for (int s = 0; s < 2; s++) {
		if (s && eye[1].bytes == eye[0].bytes)
			in[1] = in[0];
		else
			in[s].n = glb_graft(g, to, eye[s].bytes, eye[s].size, &in[s].first, err);
		if (!in[s].n)
			return err_wrap(err, "%s", eye_names[s]);
	}
	return true;
}

bool glb_write(const char *path, struct glb_report *report, const struct rig *rig, const struct drive *drive,
               const struct glb_eye eye[2], const char *name, const struct look *look, const struct glb_conf *conf, const char *made_by,
               struct err *err)
{
	struct glb_buffer g = { .views = json_array(), .accessors = json_array() };
	struct glb_bake bake;
	struct glb_skin skin = { 0 };
	struct eye_meshes in[2] = { 0 };
	json_t *samplers = json_array(), *used = json_array(), *root = json_object();
	bool ok = glb_bake_make(&bake, rig, drive, conf, err);
	if (ok) {
		*report = (struct glb_report){ bake.n_targets, bake.n, bake.worst, 0 };
		glb_skin_make(&skin, &g, rig, &bake, conf, look);
		strands_put(&skin, &g, rig, &bake, conf->hairs, conf->hair_rgb);
		tears_put(&skin, &g, rig, &bake, conf, used);
		const struct glb_arrays to = { skin.meshes, skin.materials, skin.images, skin.textures, samplers, used };
		ok = graft_eyes(in, &g, &to, eye, err);
	}
	if (ok) {
		json_t *asset = json_pack("{s:s,s:s}", "version", "2.0", "generator", "Eyewright " EYEWRIGHT_VERSION);
		json_t *made = made_by ? json_loads(made_by, 0, 0) : 0;
		if (made)
			json_object_set_new(asset, "extras", json_pack("{s:o}", "made_by", made));
		json_object_set_new(root, "asset", asset);
		// A program that cannot read whole steps cannot read the file.
		json_array_append_new(used, json_string(quantised));
		json_object_set_new(root, "extensionsRequired", json_pack("[s]", quantised));
		put_some(root, "extensionsUsed", used);
		json_t *animations = json_pack("[o]", animation(&g, rig, &bake, drive, &skin)), *blink = glb_blink(&g, &bake, &skin);
		if (blink)
			json_array_append_new(animations, blink);
		json_object_update_new(root, json_pack("{s:i,s:[{s:[i]}],s:o,s:o,s:o,s:o}", "scene", 0, "scenes", "nodes", 0, "nodes",
		                                       nodes(rig, eye, in, name, &skin), "meshes", json_incref(skin.meshes), "materials",
		                                       json_incref(skin.materials), "animations", animations));
		put_some(root, "images", skin.images);
		put_some(root, "textures", skin.textures);
		put_some(root, "samplers", samplers);
		json_object_set(root, "accessors", g.accessors);
		json_object_set(root, "bufferViews", g.views);
		json_object_set_new(root, "buffers", json_pack("[{s:I}]", "byteLength", (json_int_t)g.size));
		ok = glb_save(path, &g, root, &report->bytes, err);
	}
	json_decref(root);
	json_decref(samplers);
	json_decref(used);
	json_decref(g.accessors);
	json_decref(g.views);
	glb_skin_free(&skin);
	free(g.bin);
	glb_bake_free(&bake);
	return ok;
}
