#include "mesh/ray.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <embree3/rtcore.h>

#include "base/mem.h"

struct ray_scene {
	RTCDevice device;
	RTCScene scene;
	RTCGeometry geometry;
	float (*vertices)[3];  // Embree's own buffer
	int n_vertices, n_faces;
};

struct ray_scene *ray_scene_new(int n_vertices, const float (*vertices)[3], int n_faces, const int32_t (*faces)[3])
{
	struct ray_scene *s = mem_new(1, sizeof *s);
	s->n_vertices = n_vertices;
	s->n_faces = n_faces;
	// One build thread: the tree, and with it which of two equally near triangles is hit, is the same on any machine.
	s->device = rtcNewDevice("threads=1");
	s->scene = rtcNewScene(s->device);
	rtcSetSceneFlags(s->scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC);
	rtcSetSceneBuildQuality(s->scene, RTC_BUILD_QUALITY_LOW);  // by Morton codes: a fifth of the time, and rays are as fast
	if (n_faces) {
		s->geometry = rtcNewGeometry(s->device, RTC_GEOMETRY_TYPE_TRIANGLE);
		rtcSetGeometryBuildQuality(s->geometry, RTC_BUILD_QUALITY_LOW);
		s->vertices = rtcSetNewGeometryBuffer(s->geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
		                                      sizeof *vertices, (size_t)n_vertices);
		void *corners = rtcSetNewGeometryBuffer(s->geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof *faces,
		                                        (size_t)n_faces);
		memcpy(s->vertices, vertices, (size_t)n_vertices * sizeof *vertices);
		memcpy(corners, faces, (size_t)n_faces * sizeof *faces);
		rtcCommitGeometry(s->geometry);
		rtcAttachGeometry(s->scene, s->geometry);
	}
	rtcCommitScene(s->scene);
	return s;
}

void ray_scene_move(struct ray_scene *s, const float (*vertices)[3])
{
	if (!s->n_faces)
		return;
	memcpy(s->vertices, vertices, (size_t)s->n_vertices * sizeof *vertices);
	rtcUpdateGeometryBuffer(s->geometry, RTC_BUFFER_TYPE_VERTEX, 0);
	rtcCommitGeometry(s->geometry);
	rtcCommitScene(s->scene);
}

void ray_scene_free(struct ray_scene *s)
{
	if (!s)
		return;
	if (s->geometry)
		rtcReleaseGeometry(s->geometry);
	rtcReleaseScene(s->scene);
	rtcReleaseDevice(s->device);
	free(s);
}

static struct RTCRay ray_of(const float origin[3], const float dir[3], float near, float far)
{
	return (struct RTCRay){ .org_x = origin[0], .org_y = origin[1], .org_z = origin[2], .tnear = near, .dir_x = dir[0],
		                    .dir_y = dir[1], .dir_z = dir[2], .tfar = far, .mask = 0xffffffff };
}

/* Whether Embree can trace the ray: it ends the program at numbers that are not finite or too large. Other rays hit nothing. */
static bool can_be_traced(const float origin[3], const float dir[3])
{
	const float largest = 1e18f;  // its FLT_LARGE
	for (int k = 0; k < 3; k++)
		if (!(fabsf(origin[k]) < largest && fabsf(dir[k]) < largest))
			return false;
	return true;
}

struct ray_hit ray_first(const struct ray_scene *s, const float origin[3], const float dir[3], float near, float far)
{
	struct RTCIntersectContext context;
	struct RTCRayHit r = { .ray = ray_of(origin, dir, near, far) };
	r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
	if (!can_be_traced(origin, dir))
		return (struct ray_hit){ far, -1, 0, 0 };
	rtcInitIntersectContext(&context);
	rtcIntersect1(s->scene, &context, &r);
	bool hit = r.hit.geomID != RTC_INVALID_GEOMETRY_ID;
	return (struct ray_hit){ r.ray.tfar, hit ? (int)r.hit.primID : -1, r.hit.u, r.hit.v };
}

bool ray_blocked(const struct ray_scene *s, const float origin[3], const float dir[3], float near, float far)
{
	struct RTCIntersectContext context;
	struct RTCRay r = ray_of(origin, dir, near, far);
	if (!can_be_traced(origin, dir))
		return false;
	rtcInitIntersectContext(&context);
	rtcOccluded1(s->scene, &context, &r);
	return r.tfar < 0;
}
