/* Colours of scene_quick.h: four channels at once. */
#include <math.h>
#include <string.h>

#include "eye/scene_quick.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre")  // see scene_meet.c
#endif

typedef float colour __attribute__((vector_size(16), aligned(16)));

SIMD_INLINE colour read4(const float *p)
{
	colour c;
	memcpy(&c, p, sizeof c);
	return c;
}

/* Bilinear, from a map of four channels; u, v in texels from the first one's centre. */
SIMD_INLINE colour bilinear(const float *map, int n, float u, float v)
{
	float top = (float)n - 1.001f;
	u = u > 0 ? u < top ? u : top : 0;
	v = v > 0 ? v < top ? v : top : 0;
	int x = (int)u, y = (int)v;
	const float *a = map + 4 * ((long)y * n + x), *b = a + 4L * n;
	u -= (float)x;
	v -= (float)y;
	colour p = read4(a), q = read4(b);
	p += u * (read4(a + 4) - p);
	q += u * (read4(b + 4) - q);
	return p + v * (q - p);
}

/* Ripples of the tear film bend the normals beyond the limbus. */
static void ripple(struct quick_spots *s, int n, const struct image *film)
{
	float w = (float)film->width;
	for (int i = 0; i < n; i++) {
		if (s->rho[i] < 1.3f || s->hit[i] == 0)
			continue;
		float gx = channel_at(film->px, film->width, 1, s->su[i] * w, s->sv[i] * w, 2, 0);
		float gy = channel_at(film->px, film->width, 1, s->su[i] * w, s->sv[i] * w, 2, 1);
		float x = s->nx[i] + gx, y = s->ny[i] + gy, z = s->nz[i], inv = 1 / sqrtf(x * x + y * y + z * z);
		s->nx[i] = x * inv;
		s->ny[i] = y * inv;
		s->nz[i] = z * inv;
	}
}

/* The white of the eye: diffuse, softened by what scatters below the surface, most in the red; next to the limbus it thins
 * out over the dark of the chamber's angle. */
SIMD_INLINE colour sclera(const struct quick_spots *s, const struct quick_look *k, const float normal[3], int i)
{
	const float *v0 = k->cam_from_eye[0], *v1 = k->cam_from_eye[1], *v2 = k->cam_from_eye[2];
	float x = v0[0] * normal[0] + v0[1] * normal[1] + v0[2] * normal[2], y = v1[0] * normal[0] + v1[1] * normal[1] + v1[2] * normal[2];
	float z = v2[0] * normal[0] + v2[1] * normal[1] + v2[2] * normal[2];
	float(*q)[4] = (float(*)[4])k->sky;
	colour light = read4(q[0]) + x * read4(q[1]) + y * read4(q[2]) + z * read4(q[3]) + x * y * read4(q[4]) + y * z * read4(q[5])
	               + z * z * read4(q[6]) + x * z * read4(q[7]) + (x * x - y * y) * read4(q[8]);
	colour even = read4(k->even), bleed = { 0.38f, 0.26f, 0.20f, 0 }, rim = { 0.36f, 0.31f, 0.25f, 0 };
	float n = (float)k->scene->veins.width, edge = 1 - smooth(0.97f, 1.22f, s->rho[i]);
	for (int c = 0; c < 3; c++)
		light[c] = light[c] > 0 ? light[c] : 0;
	colour albedo = bilinear(k->scene->veins.px, k->scene->veins.width, (s->su[i] + 0.5f) * n - 0.5f, (s->sv[i] + 0.5f) * n - 0.5f);
	return albedo * (light + bleed * (even - light)) * (1 - rim * (edge * edge));
}

SIMD_INLINE colour environment(const struct envmap *env, float u, float v, float rough)
{
	float n = (float)env->sharp.width, m = (float)env->rough.width;
	colour c = bilinear(env->sharp.px, env->sharp.width, (u + 1) * 0.5f * n - 0.5f, (v + 1) * 0.5f * n - 0.5f);
	if (rough > 0)
		c += rough * (bilinear(env->rough.px, env->rough.width, (u + 1) * 0.5f * m - 0.5f, (v + 1) * 0.5f * m - 0.5f) - c);
	return c;
}

SIMD_CLONES static void put(float rgba[][4], const struct quick_spots *s, int n, const float (*normal)[3], const struct quick_look *k)
{
	const struct scene_shade *h = k->shade;
	float half = 0.5f * (float)h->n - 0.5f;
	for (int i = 0; i < n; i++) {
		colour c = { 0 };
		if (s->hit[i] > 0) {
			float lid = s->lid[i];
			if (lid > 0)
				c += lid * sclera(s, k, normal[i], i);
			if (lid < 1)
				c += (1 - lid) * (1 - s->mirror[i]) * bilinear(h->rgba, h->n, s->iu[i] * h->per_mm + half, s->iv[i] * h->per_mm + half);
			// The film is smooth on the cornea, and lies on a rough ground beyond the limbus.
			if (k->light->mirror)
				c += s->mirror[i] * environment(k->light->mirror, s->eu[i], s->ev[i], 0.75f * smooth(1.0f, 1.35f, s->rho[i]));
			c[3] = 1;
		}
		memcpy(rgba[i], &c, sizeof c);
	}
}

void quick_trace(float rgba[][4], const struct quick_rays *r, const struct quick_look *k, long *iris)
{
	struct quick_spots s;
	float normal[BATCH][3];
	int seen = 0, hit = 0, white = 0;
	quick_outside(&s, r, k);
	for (int i = 0; i < r->n; i++) {
		hit += s.hit[i] > 0;
		seen += s.hit[i] > 0 && s.lid[i] < 1;
		white += s.lid[i] > 0;
	}
	if (!hit) {
		memset(rgba, 0, (size_t)r->n * sizeof *rgba);
		return;
	}
	for (int i = 0; i < r->n && white; i++) {
		normal[i][0] = s.nx[i];
		normal[i][1] = s.ny[i];
		normal[i][2] = s.nz[i];
	}
	if (white)
		ripple(&s, r->n, &k->scene->film);
	if (seen)
		quick_iris(&s, r, k);
	quick_mirror(&s, r, k);
	put(rgba, &s, r->n, (const float(*)[3])normal, k);
	*iris += seen;
}
