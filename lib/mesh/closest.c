#include "mesh/closest.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <embree3/rtcore.h>

#include "base/mem.h"

/* The plane of a triangle and the planes perpendicular to it through its edges, facing outwards: for distances of a point from
 * all four. */
typedef float four __attribute__((vector_size(16), aligned(16)));

struct sides {
	four x, y, z, off;
};

struct closest_scene {
	const struct mesh *mesh;
	const float (*normals)[3];
	RTCDevice device;
	RTCScene scene;
	int32_t *face;  // of the mesh, for each triangle of the scene
	int32_t (*corners)[3];
	struct sides *sides;
	float slack;    // rounding of the sides' offsets
	int n;
};

static float dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(double out[3], const double a[3], const double b[3])
{
	for (int k = 0; k < 3; k++)
		out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

/* The planes of a triangle. Returns false for triangles without area. */
static bool take_sides(struct sides *out, const struct mesh *mesh, const int32_t v[3])
{
	double at[3][3], edge[3][3], n[3], m[3], longest = 0;
	for (int i = 0; i < 3; i++)
		for (int k = 0; k < 3; k++)
			at[i][k] = (double)mesh->vertices[v[i]][k];
	for (int i = 0; i < 3; i++) {
		double len2 = 0;
		for (int k = 0; k < 3; k++) {
			edge[i][k] = at[(i + 1) % 3][k] - at[i][k];
			len2 += edge[i][k] * edge[i][k];
		}
		longest = i != 1 ? fmax(longest, len2) : longest;
	}
	cross(n, edge[2], edge[0]);
	double twice = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	if (!(twice > 1e-7 * longest && longest > 0))
		return false;
	for (int i = -1; i < 3; i++) {
		if (i >= 0)
			cross(m, edge[i], n);
		const double *way = i < 0 ? n : m, *from = at[i < 0 ? 0 : i];
		double len = i < 0 ? twice : sqrt(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]), w = len > 0 ? 1 / len : 0;
		out->x[i + 1] = (float)(w * way[0]);
		out->y[i + 1] = (float)(w * way[1]);
		out->z[i + 1] = (float)(w * way[2]);
		out->off[i + 1] = (float)(-w * (way[0] * from[0] + way[1] * from[1] + way[2] * from[2]));
	}
	return true;
}

struct closest_scene *closest_new(const struct mesh *mesh, const float (*normals)[3])
{
	struct closest_scene *s = mem_new(1, sizeof *s);
	s->mesh = mesh;
	s->normals = normals;
	s->face = mem_array((size_t)mesh->n_faces + 1, sizeof *s->face);
	s->corners = mem_array((size_t)mesh->n_faces + 1, sizeof *s->corners);
	s->sides = mem_array((size_t)mesh->n_faces + 1, sizeof *s->sides);
	for (int f = 0; f < mesh->n_faces; f++)
		if (take_sides(&s->sides[s->n], mesh, mesh->faces[f])) {
			memcpy(s->corners[s->n], mesh->faces[f], sizeof *s->corners);
			s->face[s->n++] = f;
		}
	for (int i = 0; i < mesh->n_vertices; i++)
		for (int k = 0; k < 3; k++)
			s->slack = fmaxf(s->slack, 1e-6f * fabsf(mesh->vertices[i][k]));
	// One build thread: the tree is the same on any machine.
	s->device = rtcNewDevice("threads=1");
	s->scene = rtcNewScene(s->device);
	if (s->n) {
		RTCGeometry g = rtcNewGeometry(s->device, RTC_GEOMETRY_TYPE_TRIANGLE);
		// Built from Morton codes: in a fifth of the time, and as fast to search.
		rtcSetSceneBuildQuality(s->scene, RTC_BUILD_QUALITY_LOW);
		rtcSetGeometryBuildQuality(g, RTC_BUILD_QUALITY_LOW);
		// Vertices are copied, since Embree reads 16 bytes at each and the mesh's last has 12.
		void *v = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof *mesh->vertices,
		                                  (size_t)mesh->n_vertices);
		void *c = rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof *s->corners, (size_t)s->n);
		memcpy(v, mesh->vertices, (size_t)mesh->n_vertices * sizeof *mesh->vertices);
		memcpy(c, s->corners, (size_t)s->n * sizeof *s->corners);
		rtcCommitGeometry(g);
		rtcAttachGeometry(s->scene, g);
		rtcReleaseGeometry(g);
	}
	rtcCommitScene(s->scene);
	return s;
}

void closest_free(struct closest_scene *s)
{
	if (!s)
		return;
	rtcReleaseScene(s->scene);
	rtcReleaseDevice(s->device);
	free(s->face);
	free(s->corners);
	free(s->sides);
	free(s);
}

/* Barycentric weights of the point of triangle a b c closest to p (regions of the plane: Ericson, Real-Time Collision
 * Detection, 5.1.5). */
static void on_triangle(float w[3], const float p[3], const float a[3], const float b[3], const float c[3])
{
	float ab[3], ac[3], ap[3];
	for (int k = 0; k < 3; k++) {
		ab[k] = b[k] - a[k];
		ac[k] = c[k] - a[k];
		ap[k] = p[k] - a[k];
	}
	float bb = dot(ab, ab), cc = dot(ac, ac), bc = dot(ab, ac), d1 = dot(ab, ap), d2 = dot(ac, ap);
	float d3 = d1 - bb, d4 = d2 - bc, d5 = d1 - bc, d6 = d2 - cc;
	float va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
	float u = 0, v = 0;
	if (d1 <= 0 && d2 <= 0)
		;
	else if (d3 >= 0 && d4 <= d3)
		u = 1;
	else if (d6 >= 0 && d5 <= d6)
		v = 1;
	else if (vc <= 0 && d1 >= 0 && d3 <= 0)
		u = d1 / (d1 - d3);
	else if (vb <= 0 && d2 >= 0 && d6 <= 0)
		v = d2 / (d2 - d6);
	else if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
		v = (d4 - d3) / (d4 - d3 + d5 - d6);
		u = 1 - v;
	} else {
		float sum = va + vb + vc;
		u = vb / sum;
		v = vc / sum;
	}
	w[0] = 1 - u - v > 0 ? 1 - u - v : 0;
	w[1] = u;
	w[2] = v;
}

struct query {
	const struct closest_scene *scene;
	const float *at, *normal;
	float turn2, best;  // best: squared, in the measure
	float slack;        // of distances from planes
	struct closest_point found;
	int triangle;
};

static void normal_at(float n[3], const struct closest_scene *s, const int32_t v[3], const float w[3])
{
	if (s->normals)
		for (int k = 0; k < 3; k++)
			n[k] = w[0] * s->normals[v[0]][k] + w[1] * s->normals[v[1]][k] + w[2] * s->normals[v[2]][k];
	else {
		const float *a = s->mesh->vertices[v[0]], *b = s->mesh->vertices[v[1]], *c = s->mesh->vertices[v[2]];
		float e[3] = { b[0] - a[0], b[1] - a[1], b[2] - a[2] }, g[3] = { c[0] - a[0], c[1] - a[1], c[2] - a[2] };
		n[0] = e[1] * g[2] - e[2] * g[1];
		n[1] = e[2] * g[0] - e[0] * g[2];
		n[2] = e[0] * g[1] - e[1] * g[0];
	}
	float len = sqrtf(dot(n, n));
	for (int k = 0; k < 3; k++)
		n[k] = len > 0 ? n[k] / len : 0;
}

/* Whether the planes show that the triangle is further away than the best so far; false where they do not decide it. */
static bool is_beyond(const struct query *q, const struct sides *s)
{
	four away = q->at[0] * s->x + q->at[1] * s->y + q->at[2] * s->z + s->off;
	float beside = away[1] > away[2] ? away[1] : away[2];
	beside = (beside > away[3] ? beside : away[3]) - q->slack;
	float before = fabsf(away[0]) - q->slack;
	return (beside > 0 ? beside * beside : 0) + (before > 0 ? before * before : 0) > q->best;
}

/* Tests one triangle; returns true when it is closer than all before. */
static bool look(struct query *q, int triangle)
{
	const struct closest_scene *s = q->scene;
	if (is_beyond(q, &s->sides[triangle]))
		return false;
	const int32_t *v = s->corners[triangle];
	const float *a = s->mesh->vertices[v[0]], *b = s->mesh->vertices[v[1]], *c = s->mesh->vertices[v[2]];
	struct closest_point p = { .face = s->face[triangle] };
	float d2 = 0;
	on_triangle(p.bary, q->at, a, b, c);
	for (int k = 0; k < 3; k++) {
		p.at[k] = p.bary[0] * a[k] + p.bary[1] * b[k] + p.bary[2] * c[k];
		d2 += (p.at[k] - q->at[k]) * (p.at[k] - q->at[k]);
	}
	float measure = d2;
	if (!(measure <= q->best))
		return false;
	normal_at(p.normal, s, v, p.bary);
	float facing = q->normal ? dot(p.normal, q->normal) : 1;
	if (q->turn2 > 0)
		measure += q->turn2 * (facing < 1 ? 2 * (1 - facing) : 0);
	if (!(measure < q->best || (measure == q->best && triangle < q->triangle)))
		return false;
	p.distance = sqrtf(d2);
	q->found = p;
	q->best = measure;
	q->triangle = triangle;
	return true;
}

static bool visit(struct RTCPointQueryFunctionArguments *args)
{
	struct query *q = args->userPtr;
	if (!look(q, (int)args->primID))
		return false;
	args->query->radius = sqrtf(q->best);
	return true;
}

struct closest_point closest_find(const struct closest_scene *s, const float at[3], const float normal[3], float turn,
                                  float reach, int guess)
{
	struct query q = { .scene = s, .at = at, .normal = normal, .turn2 = turn * turn, .best = reach * reach,
		               .found = { .face = -1, .distance = INFINITY }, .triangle = INT32_MAX };
	if (!s->n || !isfinite(at[0]) || !isfinite(at[1]) || !isfinite(at[2]))
		return q.found;
	q.slack = s->slack + 1e-6f * (fabsf(at[0]) + fabsf(at[1]) + fabsf(at[2]));
	// Triangles are in the order of the faces, some left out: the guess's triangle is at its own number or before it.
	for (int t = guess < s->n ? guess : s->n - 1; guess >= 0 && t >= 0; t--)
		if (s->face[t] <= guess) {
			if (s->face[t] == guess)
				look(&q, t);
			break;
		}
	struct RTCPointQuery query = { .x = at[0], .y = at[1], .z = at[2], .radius = sqrtf(q.best) };
	struct RTCPointQueryContext context;
	rtcInitPointQueryContext(&context);
	rtcPointQuery(s->scene, &query, &context, visit, &q);
	return q.found;
}
