/* Colour of a point of skin. */
#include <math.h>
#include <string.h>

#include "math/vec.h"
#include "draw/face/impl.h"
#include "draw/face/skin_look.h"

/* Hash of a cell, in -1..1. */
static float hash(int x, int y, int z)
{
	uint32_t h = (uint32_t)x * 0x8da6b343u ^ (uint32_t)y * 0xd8163841u ^ (uint32_t)z * 0xcb1ab31fu;
	h ^= h >> 15;
	h *= 0x2c1b3c6du;
	h ^= h >> 12;
	h *= 0x297a2d39u;
	h ^= h >> 15;
	return (float)(h & 0xffff) / 32767.5f - 1;
}

/* Smooth noise at a point of the skin at rest. */
float portrait_noise(const float p[3], float per_mm)
{
	float f[3];
	int i[3];
	for (int c = 0; c < 3; c++) {
		float x = p[c] * per_mm;
		i[c] = (int)floorf(x);
		f[c] = x - (float)i[c];
		f[c] = f[c] * f[c] * (3 - 2 * f[c]);
	}
	float v[2];
	for (int z = 0; z < 2; z++) {
		float a = hash(i[0], i[1], i[2] + z), b = hash(i[0] + 1, i[1], i[2] + z);
		float c = hash(i[0], i[1] + 1, i[2] + z), d = hash(i[0] + 1, i[1] + 1, i[2] + z);
		v[z] = (a + f[0] * (b - a)) * (1 - f[1]) + (c + f[0] * (d - c)) * f[1];
	}
	return v[0] + f[2] * (v[1] - v[0]);
}

/* Pores: the slope of a noise of 0.5 mm cells tilts the normal. */
static void pores(float n[3], const float rest[3], float strength)
{
	static const float step = (float)SKIN_PORES_STEP, coarse = (float)SKIN_PORES_COARSE, fine = (float)SKIN_PORES_FINE;
	float at = portrait_noise(rest, coarse) + 0.5f * portrait_noise(rest, fine);
	for (int c = 0; c < 3; c++) {
		float q[3] = { rest[0], rest[1], rest[2] };
		q[c] += step;
		n[c] -= strength * (portrait_noise(q, coarse) + 0.5f * portrait_noise(q, fine) - at);
	}
}

/* Trowbridge-Reitz lobes of two roughnesses with Smith's shadowing, Schlick's Fresnel of skin. */
static void gloss(float lobe[2], const float n[3], const float l[3], const float v[3], const float rough[2])
{
	float h[3], len = 0, nh = 0, nl = 0, nv = 0, vh = 0;
	lobe[0] = lobe[1] = 0;
	for (int c = 0; c < 3; c++) {
		h[c] = l[c] + v[c];
		len += h[c] * h[c];
	}
	len = 1 / sqrtf(len + 1e-12f);
	for (int c = 0; c < 3; c++) {
		nh += n[c] * h[c] * len;
		vh += v[c] * h[c] * len;
		nl += n[c] * l[c];
		nv += n[c] * v[c];
	}
	if (nl <= 0 || nv <= 0)
		return;
	const float f0 = (float)SKIN_MIRROR, s = 1 - fmaxf(vh, 0), f = f0 + (1 - f0) * s * s * s * s * s;
	for (int i = 0; i < 2; i++) {
		const float a2 = rough[i] * rough[i] * rough[i] * rough[i], d = nh * nh * (a2 - 1) + 1, k = 0.5f * rough[i] * rough[i];
		const float g = nl / (nl * (1 - k) + k) * nv / (nv * (1 - k) + k);
		lobe[i] = a2 / (d * d) * g * f / (4 * nv);  // times pi / pi: lights are irradiance over pi
	}
}

struct point {
	float tilt[3], rough;  // of the character's own textures, with dressed
	bool dressed, bumpy;
	float x[3], rest[3], normal[3], light[3], albedo[3], open, wet, weight[3];
};

static struct point point_of(const struct portrait_mesh *m, int face, const float origin[3], const float dir[3])
{
	const int32_t *v = m->faces[face];
	float w[3], len = 0;
	portrait_mesh_weights(w, m, face, origin, dir);
	struct point p = { 0 };
	for (int j = 0; j < 3; j++) {
		int i = v[j];
		for (int d = 0; d < 3; d++) {
			p.x[d] += w[j] * m->x[i][d];
			p.rest[d] += w[j] * m->rest[i][d];
			p.normal[d] += w[j] * m->normal[i][d];
			p.light[d] += w[j] * m->light[i][d];
			p.albedo[d] += w[j] * m->albedo[i][d];
		}
		p.open += w[j] * m->open[i];
		p.wet += w[j] * m->wet[i];
	}
	for (int d = 0; d < 3; d++)
		len += p.normal[d] * p.normal[d];
	memcpy(p.weight, w, sizeof w);
	for (int d = 0; d < 3; d++)
		p.normal[d] /= sqrtf(len) + 1e-12f;
	return p;
}

void portrait_bare_light(float rgb[3], const struct portrait *p, int face, const float origin[3], const float dir[3])
{
	const struct point q = point_of(&p->mesh, face, origin, dir);
	const int32_t *v = p->mesh.faces[face];
	const float under = portrait_under_hair(p, q.x, q.normal);
	for (int c = 0; c < 3; c++)
		rgb[c] = under * (q.weight[0] * p->mesh.bare[v[0]][c] + q.weight[1] * p->mesh.bare[v[1]][c] + q.weight[2] * p->mesh.bare[v[2]][c]);
}

/* Mucous membrane: the grain of skin's pores, but higher, below a film of tears. */
static void moist(float rgb[3], const struct portrait *p, const struct portrait_sky *sky, const struct point *q, const float n[3], const float dir[3])
{
	float film[3];
	for (int c = 0; c < 3; c++)
		film[c] = q->normal[c] + (float)CARUNCLE_LOBES * (n[c] - q->normal[c]);
	vecf_unit(film);
	portrait_wet_shade(rgb, p, sky->rig_from_cam, film, dir, q->wet, q->open);
}

void portrait_normal(float n[3], const struct portrait *p, int face, const float origin[3], const float dir[3])
{
	const struct portrait_mesh *m = &p->mesh;
	if (face < p->first_lash) {
		struct point q = point_of(m, face, origin, dir);
		memcpy(n, q.normal, sizeof q.normal);
		return;
	}
	const int32_t *v = m->faces[face];
	double a[3], b[3], flat[3];
	for (int c = 0; c < 3; c++) {
		a[c] = (double)m->x[v[1]][c] - (double)m->x[v[0]][c];
		b[c] = (double)m->x[v[2]][c] - (double)m->x[v[0]][c];
	}
	vec_cross(flat, a, b);
	vec_unit(flat, flat);
	for (int c = 0; c < 3; c++)
		n[c] = (float)flat[c];
}

/* The normal of a map in the frame of the texture as it lies on the posed face. */
static void bump(float n[3], const struct portrait_mesh *m, int face, const float tilt[3])
{
	const int32_t *v = m->faces[face];
	const float (*t)[2] = (const float(*)[2])m->uv[face];
	const float a = t[1][0] - t[0][0], b = t[1][1] - t[0][1], c = t[2][0] - t[0][0], d = t[2][1] - t[0][1], side = a * d - b * c < 0 ? -1 : 1;
	float along[3], up[3], la = 1e-12f, lu = 1e-12f;
	for (int i = 0; i < 3; i++) {
		const float e = m->x[v[1]][i] - m->x[v[0]][i], g = m->x[v[2]][i] - m->x[v[0]][i];
		along[i] = side * (d * e - b * g);
		up[i] = -side * (a * g - c * e);
		la += along[i] * along[i];
		lu += up[i] * up[i];
	}
	for (int i = 0; i < 3; i++)
		n[i] = tilt[2] * n[i] + tilt[0] * along[i] / sqrtf(la) + tilt[1] * up[i] / sqrtf(lu);
}

/* The character's own textures at a point. wide: of what a pixel shows there, mm. Moist places stay as they are. */
static void wear(struct point *q, const struct portrait *p, int face, float wide)
{
	struct dress_point at;
	float uv[2];
	portrait_uv_at(uv, &p->mesh, face, q->weight);
	dress_at(&at, p->conf.dress, p->mesh.material[face], uv, wide * p->mesh.uv_per_mm[face]);
	q->dressed = true;
	q->bumpy = at.bumpy;
	q->rough = fminf(fmaxf(at.rough, 0.15f), 1);
	memcpy(q->tilt, at.tilt, sizeof q->tilt);
	for (int c = 0; c < 3; c++)
		q->albedo[c] += (1 - q->wet) * (at.rgb[c] - q->albedo[c]);
}

void portrait_shade(float rgb[3], const struct portrait *p, const struct portrait_sky *sky, int face, const float origin[3],
                    const float dir[3], const float *light)
{
	struct point q = point_of(&p->mesh, face, origin, dir);
	const float under = face < p->first_lash ? portrait_under_hair(p, q.x, q.normal) : 1;
	q.open *= under;
	for (int c = 0; c < 3; c++)
		q.light[c] = light ? light[c] : under * q.light[c];
	if (face < p->mesh.n_dressed)
		wear(&q, p, face, sky->pixel_mm);
	float strength = (float)p->conf.texture * sky->detail, to[3] = { -dir[0], -dir[1], -dir[2] }, n[3], grain = 0;
	// Its own roughness against that of skin, whose two lobes these are.
	const float rougher = q.dressed ? q.rough / 0.5f : 1;
	if (p->folded)
		portrait_fold(q.normal, q.light, p, sky, face, q.weight);
	memcpy(n, q.normal, sizeof n);
	if (q.bumpy)
		bump(n, &p->mesh, face, q.tilt);
	else if (q.dressed && strength > 0)  // its colour has blotches of its own
		pores(n, q.rest, (float)SKIN_PORES * strength);
	else if (strength > 0) {
		pores(n, q.rest, (float)SKIN_PORES * strength);
		grain = (float)SKIN_GRAIN * strength * portrait_noise(q.rest, (float)SKIN_GRAIN_CELLS);
	}
	vecf_unit(n);
	float spec[3] = { 0 };
	const float rough[2] = { fminf((float)SKIN_ROUGH_WIDE * rougher, 1), fminf((float)SKIN_ROUGH_NARROW * rougher, 1) };
	for (int k = 0; k < sky->n && !p->matte; k++) {
		float lobe[2];
		gloss(lobe, n, sky->light[k].dir, to, rough);
		const float shine = (float)SKIN_LOBE_WIDE * lobe[0] + (float)SKIN_LOBE_NARROW * lobe[1];
		for (int c = 0; c < 3; c++)
			spec[c] += shine * sky->light[k].rgb[c];
	}
	// What pores do to the diffuse light: a little of their slope against the surface's own.
	float relief = 1;
	for (int c = 0; c < 3; c++)
		relief += (float)SKIN_PORES_LIGHT * (n[c] - q.normal[c]) * sky->light[0].dir[c];
	for (int c = 0; c < 3; c++)
		rgb[c] = q.albedo[c] * (1 + grain) * q.light[c] * relief + spec[c] * q.open * (1 - q.wet);
	if (q.wet > 0) {
		if (q.bumpy) {  // a film's lobes are those of pores, not of a map of skin
			memcpy(n, q.normal, sizeof n);
			pores(n, q.rest, (float)SKIN_PORES * strength);
			vecf_unit(n);
		}
		moist(rgb, p, sky, &q, n, dir);
	}
}
