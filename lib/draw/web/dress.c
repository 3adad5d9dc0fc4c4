/* A character's own colours for the page: its textures as they lie on it at rest, on a cylinder about an axis behind the eyes. One chart of
 * one size whatever textures, materials and seams the character has; hair cards that stand on the skin are painted onto it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "draw/web/base64.h"
#include "draw/web/face_impl.h"
#include "image/picture.h"
#include "math/vec.h"

enum { WIDTH = 2048, QUALITY = 88, LAYERS = 64 };

static const double behind = 70, half_turn = 2.0, half_height = 110;  // mm, rad to either side, mm up and down

/* The rig's axes of a point in the head's, about the middle of both eyes. */
static void to_rig(float out[3], const struct web_face *f, const double x[3], bool point)
{
	double d[3];
	mat_tvec(d, f->rig->head_from_target, x);
	for (int c = 0; c < 3; c++)
		out[c] = (float)(d[c] + (point ? f->middle[c] : 0));
}

/* The outermost skin that a ray from outside meets, and what hangs before it. False: none. */
static bool look_in(uint8_t rgb[3], const struct web_face *f, const struct ray_scene *scene, const float from[3], const float dir[3], float wide)
{
	const struct portrait_mesh *m = &f->portrait->mesh;
	float near = 0;
	for (int k = 0; k < LAYERS; k++) {
		const struct ray_hit hit = ray_first(scene, from, dir, near, 400);
		if (hit.face < 0)
			return false;
		const float w[3] = { 1 - hit.u - hit.v, hit.u, hit.v };
		float uv[2] = { 0 }, facing = 0;
		for (int j = 0; j < 3; j++)
			for (int c = 0; c < 3; c++) {
				facing += w[j] * m->normal[m->faces[hit.face][j]][c] * dir[c];
				uv[c % 2] += c < 2 ? w[j] * m->uv[hit.face][j][c] : 0;
			}
		struct dress_point at;
		dress_at(&at, f->portrait->conf.dress, m->material[hit.face], uv, wide * m->uv_per_mm[hit.face]);
		if (at.alpha > 0) {
			for (int c = 0; c < 3; c++)
				rgb[c] = (uint8_t)lrintf(255 * fminf(srgb_from_linear(at.rgb[c]), 1));
			return facing < 0 || m->cuts[hit.face];
		}
		near = hit.t + 1e-3f;
	}
	return false;
}

/* Texels that show no skin, as the open eyes, take on what is beside them. */
static void fill_row(uint8_t *row, const bool *known, int width)
{
	for (int x = 0; x < width; x++) {
		int left = x, right = x;
		while (left >= 0 && !known[left])
			left--;
		while (right < width && !known[right])
			right++;
		if (left < 0 && right >= width)
			return;
		left = left < 0 ? right : left;
		right = right >= width ? left : right;
		for (int c = 0; c < 3 && !known[x]; c++)
			row[3 * x + c] = (uint8_t)((row[3 * left + c] + row[3 * right + c]) / 2);
	}
}

bool web_put_dress(json_t *out, const struct web_face *f, struct err *err)
{
	const struct portrait_mesh *m = &f->portrait->mesh;
	if (!m->n_dressed)
		return true;
	const int height = (int)lrint(WIDTH * half_height / (half_turn * (behind + 20)));
	uint8_t *px = mem_new(3 * (size_t)WIDTH * (size_t)height, 1), *jpeg;
	bool *known = mem_new((size_t)WIDTH * (size_t)height, 1);
	struct ray_scene *scene = ray_scene_new(m->n, (const float(*)[3])m->rest, m->n_dressed, (const int32_t(*)[3])m->faces);
	const float wide = (float)(2 * half_height / height);
#pragma omp parallel for schedule(dynamic, 8)
	for (int y = 0; y < height; y++) {
		for (int x = 0; x < WIDTH; x++) {
			const double a = half_turn * (2 * (x + 0.5) / WIDTH - 1), up = half_height * (1 - 2 * (y + 0.5) / height);
			float from[3], dir[3];
			to_rig(from, f, (double[3]){ 300 * sin(a), up, 300 * cos(a) - behind }, true);
			to_rig(dir, f, (double[3]){ -sin(a), 0, -cos(a) }, false);
			known[(size_t)y * WIDTH + (size_t)x] = look_in(px + 3 * ((size_t)y * WIDTH + (size_t)x), f, scene, from, dir, wide);
		}
		fill_row(px + 3 * (size_t)y * WIDTH, known + (size_t)y * WIDTH, WIDTH);
	}
	ray_scene_free(scene);
	size_t size;
	const bool ok = picture_jpeg_encode(&jpeg, &size, px, WIDTH, height, 3, QUALITY, err);
	if (ok) {
		json_t *map = json_pack("{s:i,s:i,s:o}", "width", (int)WIDTH, "height", height, "jpeg", base64_json(jpeg, size));
		double place[3] = { behind, half_turn, half_height };
		json_object_set_new(out, "dress", json_pack("{s:o,s:o}", "map", map, "place", json_numbers(3, place)));
		free(jpeg);
	}
	free(px);
	free(known);
	return ok;
}
