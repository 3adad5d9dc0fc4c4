#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "rig/hair/impl.h"

static const double before = 100, behind = 140;  // units: where rays begin; how far they go

/* From the front's axes to the rig's: a place, or a direction. */
static void to_rig(float out[3], const struct front *f, const double at[3], bool place)
{
	const double head[3] = { f->side ? -at[0] : at[0], at[1], at[2] };
	double v[3];
	mat_tvec(v, f->rig->head_from_target, head);
	for (int c = 0; c < 3; c++)
		out[c] = (float)(place ? f->rig->globe[f->side].center[c] + f->scale * v[c] : v[c]);
}

void front_of(double at[3], const struct front *f, const float x[3])
{
	double d[3];
	for (int c = 0; c < 3; c++)
		d[c] = ((double)x[c] - f->rig->globe[f->side].center[c]) / f->scale;
	mat_vec(at, f->rig->head_from_target, d);
	at[0] *= f->side ? -1 : 1;
}

bool front_skin(struct front_hit *hit, const struct front *f, double x, double y)
{
	float from[3], dir[3];
	to_rig(from, f, (double[]){ x, y, before }, true);
	to_rig(dir, f, (double[]){ 0, 0, -1 }, false);
	const struct ray_hit h = ray_first(f->skin, from, dir, 0, (float)(behind * f->scale));
	if (h.face < 0)
		return false;
	*hit = (struct front_hit){ .z = before - h.t / f->scale, .face = f->face[h.face], .weight = { 1 - h.u - h.v, h.u, h.v } };
	double n[3] = { 0 };
	for (int k = 0; k < 3; k++)
		for (int c = 0; c < 3; c++)
			n[c] += hit->weight[k] * f->rig->normal[f->rig->faces[hit->face][k]][c];
	mat_vec(hit->normal, f->rig->head_from_target, n);
	hit->normal[0] *= f->side ? -1 : 1;
	vec_unit(hit->normal, hit->normal);
	return true;
}

double front_globe(const struct front *f, double x, double y)
{
	double z = 12;
	for (int round = 0; round < 4; round++) {
		const double head[3] = { f->side ? -x : x, y, z > 0 ? z : 0 };
		const double radius = globe_map_at(&f->rig->globe[f->side].map, (float[]){ (float)head[0], (float)head[1], (float)head[2] }) / f->scale;
		const double square = radius * radius - x * x - y * y;
		if (!(square > 0))
			return NAN;
		z = sqrt(square);
	}
	return z;
}

void front_add_local(struct hairs *h, const struct front *f, const struct front_hit *root, int kind, int n, const double (*local)[3], double half)
{
	h->hair = mem_grow(h->hair, (size_t)h->n + 1, sizeof *h->hair);
	h->local = mem_grow(h->local, (size_t)(h->n_points + n) + 1, sizeof *h->local);
	struct hair *hair = &h->hair[h->n++];
	*hair = (struct hair){ .side = f->side, .kind = kind, .first = h->n_points, .n = n, .half = (float)(half * f->scale) };
	memcpy(hair->vertex, f->rig->faces[root->face], sizeof hair->vertex);
	memcpy(hair->weight, root->weight, sizeof hair->weight);
	for (int k = 0; k < n; k++)
		for (int c = 0; c < 3; c++)
			h->local[h->n_points + k][c] = (float)(f->scale * local[k][c]);
	h->n_points += n;
}

void front_add(struct hairs *h, const struct front *f, const struct front_hit *root, int kind, int n, const double (*point)[3], double half)
{
	double local[HAIR_LASH_POINTS][3] = { { 0 } };
	front_add_local(h, f, root, kind, n, (const double(*)[3])local, half);
	const struct hair *hair = &h->hair[h->n - 1];
	const struct hair_frame frame = hair_frame_of(hair, f->rig, (const float(*)[3])f->rig->rest);
	const float *const axis[3] = { frame.off, frame.along, frame.up };
	for (int k = 0; k < n; k++) {
		float at[3];
		to_rig(at, f, point[k], true);
		for (int i = 0; i < 3; i++) {
			float sum = 0;
			for (int c = 0; c < 3; c++)
				sum += axis[i][c] * (at[c] - frame.root[c]);
			h->local[hair->first + k][i] = sum;
		}
	}
}

/* Whether a hair goes through skin further from its root than a hair's breadth or two. */
static bool goes_through(const struct hairs *h, const struct front *f, const struct hair *hair)
{
	float point[HAIR_LASH_POINTS][3], dir[3];
	hair_place(point, h, hair, f->rig, (const float(*)[3])f->rig->rest);
	for (int k = 0; k + 1 < hair->n; k++) {
		float len = 0;
		for (int c = 0; c < 3; c++) {
			dir[c] = point[k + 1][c] - point[k][c];
			len += dir[c] * dir[c];
		}
		len = sqrtf(len);
		for (int c = 0; c < 3; c++)
			dir[c] /= len;
		if (ray_blocked(f->skin, point[k], dir, k ? 0 : 0.3f * (float)f->scale, len))
			return true;
	}
	return false;
}

void front_clear(struct hairs *h, const struct front *f)
{
	enum { TRIES = 10 };
	const struct hair *hair = &h->hair[h->n - 1];
	const float *last = h->local[hair->first + hair->n - 1], length = sqrtf(last[0] * last[0] + last[1] * last[1] + last[2] * last[2]), step = 0.1f * length;
	for (int i = 0; i < TRIES && goes_through(h, f, hair); i++) {
		for (int k = 1; k < hair->n; k++)
			h->local[hair->first + k][0] += step * (float)k / (float)(hair->n - 1);
		const float shorter = length / sqrtf(last[0] * last[0] + last[1] * last[1] + last[2] * last[2]);
		for (int k = 1; k < hair->n; k++)  // as long as it was
			for (int c = 0; c < 3; c++)
				h->local[hair->first + k][c] *= shorter;
	}
}
