/* A batch of rays of sight: which part of the eye each meets, and its colour there. */
#include "draw/eye/exact/trace.h"

#include <math.h>

#include "draw/eye/colour.h"
#include "draw/eye/march/march.h"
#include "draw/eye/pupil.h"
#include "draw/eye/sclera.h"

/* Fresnel reflectance, unpolarised, from air. */
static float mirror(float cos_i)
{
	float n = (float)LOOK_FILM_INDEX, c = cos_i > 0 ? cos_i : 0, t = sqrtf(n * n - 1 + c * c);
	float s = (c - t) / (c + t), p = (n * n * c - t) / (n * n * c + t);
	return 0.5f * (s * s + p * p);
}

static void to_cam(float out[3], const struct scene_look *look, const float a[3])
{
	for (int i = 0; i < 3; i++)
		out[i] = look->cam_from_eye[i][0] * a[0] + look->cam_from_eye[i][1] * a[1] + look->cam_from_eye[i][2] * a[2];
}

/* Where a ray meets the outside of the eye. */
struct spot {
	float at[3], normal[3];
	float rho;     // 1 on the limbus
	float cos_i;
	bool hit;
};

static bool sphere_hit(float t[1], const struct scene *s, const struct scene_look *look, const float d[3])
{
	double o[3] = { look->origin[0], look->origin[1], look->origin[2] - s->sclera_z }, R = s->conf.sclera_radius;
	double b = o[0] * d[0] + o[1] * d[1] + o[2] * d[2], c = o[0] * o[0] + o[1] * o[1] + o[2] * o[2] - R * R;
	double disc = b * b - c;
	if (disc < 0)
		return false;
	*t = (float)(-b - sqrt(disc));
	return *t > 0;
}

static struct spot spot_of(const struct scene *s, const struct scene_look *look, const float d[3], bool cornea,
                           const float K[3])
{
	struct spot p = { .hit = cornea };
	float ts, tk = INFINITY, center[3] = { 0, 0, (float)s->sclera_z };
	if (cornea) {
		tk = 0;
		for (int i = 0; i < 3; i++) {
			p.at[i] = K[i];
			tk += (K[i] - (float)look->origin[i]) * d[i];
		}
	}
	if (sphere_hit(&ts, s, look, d) && ts < tk) {
		p.hit = true;
		for (int i = 0; i < 3; i++)
			p.at[i] = (float)(look->origin[i] + (double)ts * d[i]);
	}
	if (!p.hit)
		return p;
	// The corneal normal is blended into the sphere's across the sulcus, so that no crease shows where they meet.
	float R = (float)s->cornea.R, q = (float)s->cornea.p, x = p.at[0], y = p.at[1], z = p.at[2];
	float front[3] = { x, y, q * z - R }, round[3], n = 0;
	float len = sqrtf(front[0] * front[0] + front[1] * front[1] + front[2] * front[2]);
	float u = x / (float)s->limbus[0], v = y / (float)s->limbus[1];
	p.rho = z < center[2] ? sqrtf(u * u + v * v) : 2;
	float blend = smooth(LOOK_SEAM_FROM, LOOK_SEAM_TO, p.rho);
	for (int i = 0; i < 3; i++) {
		round[i] = (p.at[i] - center[i]) / (float)s->conf.sclera_radius;
		p.normal[i] = front[i] / len + blend * (round[i] - front[i] / len);
		n += p.normal[i] * p.normal[i];
	}
	for (int i = 0; i < 3; i++)
		p.normal[i] /= sqrtf(n);
	p.cos_i = -(p.normal[0] * d[0] + p.normal[1] * d[1] + p.normal[2] * d[2]);
	return p;
}

static void add_mirror(float rgb[3], const struct spot *p, const struct scene_look *look, const float d[3])
{
	float r[3], cam[3], seen[3], f = mirror(p->cos_i);
	for (int i = 0; i < 3; i++)
		r[i] = d[i] + 2 * p->cos_i * p->normal[i];
	to_cam(cam, look, r);
	// The film is smooth on the cornea, and lies on a rough ground beyond the limbus.
	envmap_at(seen, look->light->mirror, cam, (float)LOOK_FILM_ROUGH * smooth(LOOK_FILM_FROM, LOOK_FILM_TO, p->rho));
	for (int c = 0; c < 3; c++)
		rgb[c] += f * seen[c];
}

/* The white of the eye: diffuse below its film. Light spreads by half a millimetre in it, of 12 that the eye is in radius: no shade changes with that. */
static void sclera_colour(float rgb[3], struct spot *p, const struct scene *s, const struct scene_look *look)
{
	float albedo[3], cam[3], light[3];
	to_cam(cam, look, p->normal);
	envmap_wet(light, look->light->env, cam);
	scene_sclera(albedo, p->normal, s, p->at);
	// Next to the limbus the sclera thins out over the dark of the chamber's angle: cooler and darker.
	float edge = 1 - smooth(LOOK_RIM_FROM, LOOK_RIM_TO, p->rho), rim[3] = { LOOK_RIM_DARK };
	for (int c = 0; c < 3; c++)
		rgb[c] = albedo[c] * light[c] * (1 - rim[c] * edge * edge);
}

static void iris_colour(float rgb[3], const struct scene *s, const struct scene_level *level, float soft,
                        const struct iris_batch *b, int i, float own)
{
	float cover[3];
	for (int c = 0; c < 3; c++)
		rgb[c] = b->rgb[c][i];
	scene_colour(rgb, s, level, b->px[i], b->py[i], own);
	scene_pupil(cover, s, b->px[i], b->py[i], soft);
	for (int c = 0; c < 3; c++)
		rgb[c] *= cover[c];
}

/* Colours the rays of a batch that pass through the cornea, packed together. */
static void see_iris(struct iris_batch *b, const struct scene *s, const struct scene_look *look)
{
	for (int i = 0; i < b->n; i++) {
		float x = b->fx[i], y = b->fy[i], u = b->vx[i], v = b->vy[i];
		const float *p = look->slip[0], *q = look->slip[1];
		b->fx[i] += p[0] * x + p[1] * y + p[2];
		b->fy[i] += q[0] * x + q[1] * y + q[2];
		b->vx[i] += p[0] * u + p[1] * v;
		b->vy[i] += q[0] * u + q[1] * v;
	}
	scene_meet(b, s, look->level);
	if (look->textured)
		scene_flat(b, s, look->beams);
	else
		scene_scatter(b, s, look->level, look->beams);
}

void scene_trace(float rgba[][4], int n, const float *dx, const float *dy, const float *dz, const struct scene *s,
                 const struct scene_look *look, long *iris)
{
	float K[3][BATCH], F[3][BATCH], I[3][BATCH], lid[BATCH];
	unsigned char hit[BATCH];
	struct spot spot[BATCH];
	struct iris_batch b = { 0 };
	int from[BATCH];
	cornea_sight_batch(&(struct sight_rays){ n, dx, dy, dz, K[0], K[1], K[2], F[0], F[1], F[2], I[0], I[1], I[2], hit },
	                   &s->cornea, look->origin);
	float width = (float)(s->conf.limbus_width / s->limbus[0]);
	for (int i = 0; i < n; i++) {
		spot[i] = spot_of(s, look, (float[3]){ dx[i], dy[i], dz[i] }, hit[i], (float[3]){ K[0][i], K[1][i], K[2][i] });
		lid[i] = hit[i] ? smooth(1 - 0.5f * width, 1 + 0.5f * width, spot[i].rho) : 1;
		if (!spot[i].hit || lid[i] >= 1)
			continue;
		int k = b.n++;
		from[k] = i;
		b.fx[k] = F[0][i], b.fy[k] = F[1][i], b.fz[k] = F[2][i];
		b.vx[k] = I[0][i], b.vy[k] = I[1][i], b.vz[k] = I[2][i];
	}
	*iris += b.n;
	if (b.n)
		see_iris(&b, s, look);
	for (int i = 0; i < n; i++) {
		for (int c = 0; c < 4; c++)
			rgba[i][c] = 0;
		rgba[i][3] = spot[i].hit ? 1 : 0;
		if (spot[i].hit && lid[i] > 0) {
			float white[3];
			sclera_colour(white, &spot[i], s, look);
			for (int c = 0; c < 3; c++)
				rgba[i][c] = lid[i] * (1 - mirror(spot[i].cos_i)) * white[c];
		}
	}
	for (int k = 0; k < b.n; k++) {
		int i = from[k];
		float seen[3], through = (1 - lid[i]) * (1 - mirror(spot[i].cos_i));
		iris_colour(seen, s, look->level, look->soft, &b, k, look->beams->own);
		for (int c = 0; c < 3; c++)
			rgba[i][c] += through * seen[c];
	}
	for (int i = 0; i < n && look->light->mirror; i++)
		if (spot[i].hit)
			add_mirror(rgba[i], &spot[i], look, (float[3]){ dx[i], dy[i], dz[i] });
}
