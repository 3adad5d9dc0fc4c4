#include <stdlib.h>
#include <string.h>

#include "math/vec.h"
#include "register/nricp/align_impl.h"

/* The 24 rotations of a cube, the identity first. */
static int cube_rotations(double out[24][3][3])
{
	int n = 0;
	memset(out, 0, 24 * sizeof *out);
	for (int code = 0; code < 48; code++) {
		int axis[3] = { code / 16, 0, 0 }, odd = code / 8 & 1;
		axis[1] = (axis[0] + 1 + odd) % 3;
		axis[2] = 3 - axis[0] - axis[1];
		int sign[3] = { code & 1 ? -1 : 1, code & 2 ? -1 : 1, code & 4 ? -1 : 1 };
		if (sign[0] * sign[1] * sign[2] * (odd ? -1 : 1) < 0)
			continue;
		for (int k = 0; k < 3; k++)
			out[n][k][axis[k]] = sign[k];
		n++;
	}
	return n;
}

/* Refines the pose from one start and keeps it when it is better. */
static void attempt(struct best *best, struct search *s, struct pose pose, int start)
{
	double rms, matched = align_refine(&pose, &rms, s, s->conf->rounds, s->conf->welsch);
	// Of starts that end alike the first is kept: it needed the least rotation.
	if (matched > best->matched * 1.02 || !best->start)
		*best = (struct best){ pose, matched, rms, start + 1 };
}

/* Starts with the fixed mesh upright at places all over the moving one, to find a face on a body. A few rounds at each choose one. */
static void attempt_places(struct best *best, struct search *s)
{
	static const double coarse[2] = { 0.5, 0.3 };
	double *area = mesh_vertex_areas(&s->moving), sum = 0, passed = 0, top = -1, rms, out[3] = { 0 };
	struct pose chosen = pose_still;
	int n = 0;
	for (int k = 0; k < s->n; k++)  // mean normal: the direction from the fixed mesh's centroid to its surface
		vec_add(out, out, 1.0 / s->n, s->samples[k].normal);
	for (int i = 0; i < s->moving.n_vertices; i++)
		sum += area[i];
	for (int i = 0; i < s->moving.n_vertices; i++) {
		passed += area[i];
		if (!(passed > sum * (n + 0.5) / s->conf->starts))
			continue;
		n++;
		struct pose pose = pose_still;
		for (int k = 0; k < 3; k++)
			pose.shift[k] = (double)s->moving.vertices[i][k] - 0.5 * out[k];
		double matched = align_refine(&pose, &rms, s, 3, coarse);
		if (matched > top) {
			top = matched;
			chosen = pose;
		}
	}
	free(area);
	attempt(best, s, chosen, 26);
}

struct best align_find(struct search *s, const double offset[3])
{
	struct best best = { .pose = pose_still };
	struct pose pose = pose_still;
	double cube[24][3][3];
	memcpy(pose.shift, offset, sizeof pose.shift);
	attempt(&best, s, pose, 0);
	if (best.matched < s->conf->good)
		attempt(&best, s, pose_still, 1);
	int n = cube_rotations(cube);
	if (best.matched < s->conf->good && s->conf->starts)
		attempt_places(&best, s);
	for (int i = 1; i < n && best.matched < s->conf->good; i++) {
		pose = pose_still;
		memcpy(pose.rotation, cube[i], sizeof cube[i]);
		attempt(&best, s, pose, 1 + i);
	}
	return best;
}
