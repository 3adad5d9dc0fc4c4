#include "rig/glb/blink.h"

#include <stdlib.h>

#include "base/mem.h"
#include "rig/glb/halves.h"

enum { DOWN = 7, UP = 17, KEYS = DOWN + UP + 1 };
static const double key_s = 0.01;

/* 0 open .. 1 shut. */
static double closure(int key)
{
	const double t = key < DOWN ? (double)key / DOWN : (double)(KEYS - 1 - key) / UP;
	return t * t * t * (10 + t * (6 * t - 15));
}

json_t *glb_blink(struct glb_buffer *g, const struct glb_bake *b, const struct glb_skin *skin)
{
	if (!b->n_poses)
		return 0;
	float time[KEYS];
	json_t *samplers = json_array(), *channels = json_array();
	for (int k = 0; k < KEYS; k++)
		time[k] = (float)(key_s * k);
	const int input = glb_add_floats(g, time, KEYS, 1, true, 0);
	for (int i = 0; i < skin->n; i++) {
		if (!skin->ours[i])
			continue;
		const size_t all = (size_t)skin->all[i], blink = (size_t)b->n_targets, half = blink + (size_t)(b->n_poses - GLB_HALVES);
		float *weight = mem_new(KEYS * all + 1, sizeof *weight);
		for (size_t k = 0; k < KEYS; k++)
			for (size_t eye = 0; eye < 2; eye++) {
				weight[k * all + blink + eye] = (float)closure((int)k);
				weight[k * all + half + eye] = (float)glb_half_weight(closure((int)k));
			}
		json_array_append_new(samplers, json_pack("{s:i,s:i}", "input", input, "output", glb_add_shares(g, weight, KEYS * all)));
		json_array_append_new(channels, json_pack("{s:i,s:{s:i,s:s}}", "sampler", (int)json_array_size(samplers) - 1, "target", "node", 1 + i, "path", "weights"));
		free(weight);
	}
	if (!json_array_size(channels)) {
		json_decref(samplers);
		json_decref(channels);
		return 0;
	}
	return json_pack("{s:s,s:o,s:o}", "name", "blink", "samplers", samplers, "channels", channels);
}
