/* Geometry of quick.h, sixteen rays at a time. */
#include "draw/eye/quick/quick.h"

#include <math.h>
#include <string.h>

#include "draw/eye/march/march.h"
#include "draw/eye/sclera.h"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC optimize("no-tree-pre")  // see draw/eye/march/meet.c
#endif

struct lane {
	float o[3], d[3];
};

/* As in optics/cornea/batch.c, in float: moves the origin to where the ray enters the quadric and bends it. *cosine: of incidence. */
SIMD_INLINE float enter(struct lane *r, struct quick_quadric q, float g[3], float *cosine)
{
	float x = r->o[0], y = r->o[1], z = r->o[2] - q.apex, dx = r->d[0], dy = r->d[1], dz = r->d[2];
	float A = dx * dx + dy * dy + q.p * dz * dz, B = x * dx + y * dy + (q.p * z - q.R) * dz;
	float C = x * x + y * y + z * (q.p * z - 2 * q.R), disc = B * B - A * C, root = sqrtf(disc > 0 ? disc : 0);
	float t = C / (root - B);
	x += t * dx;
	y += t * dy;
	z += t * dz;
	float g2 = q.R * q.R + (1 - q.p) * z * (2 * q.R - q.p * z), d2 = dx * dx + dy * dy + dz * dz;
	float f = (root - sqrtf(disc + q.m2 * g2 * d2)) / g2;
	r->o[0] = x;
	r->o[1] = y;
	r->o[2] = z + q.apex;
	g[0] = x;
	g[1] = y;
	g[2] = q.p * z - q.R;
	for (int c = 0; c < 3; c++)
		r->d[c] += f * g[c];
	*cosine = root / sqrtf(g2);
	return disc >= 0 && B < 0 && q.p * z <= q.R ? 1.0f : 0.0f;
}

/* Angle over sine from the cosine, 0..pi: acos by Abramowitz and Stegun 4.4.45, to 7e-5. */
SIMD_INLINE float angle_over_sine(float c)
{
	float a = c < 0 ? -c : c, poly = ((-0.0187293f * a + 0.0742610f) * a - 0.2121144f) * a + 1.5707288f, low = 1 - a > 1e-6f ? 1 - a : 1e-6f;
	float sine = sqrtf(low * (1 + a)), angle = sqrtf(low) * poly;
	return (c < 0 ? 3.14159265f - angle : angle) / sine;
}

SIMD_INLINE float fresnel(float cosine)
{
	float n = (float)LOOK_FILM_INDEX, c = cosine > 0 ? cosine : 0, t = sqrtf(n * n - 1 + c * c);
	float s = (c - t) / (c + t), p = (n * n * c - t) / (n * n * c + t);
	return 0.5f * (s * s + p * p);
}

SIMD_INLINE void outside_lane(int i, struct quick_spots *restrict s, const struct quick_rays *restrict r, const struct quick_look *restrict k, bool two)
{
	struct lane ray = { { r->ox[i], r->oy[i], r->oz[i] }, { r->dx[i], r->dy[i], r->dz[i] } };
	float g[3], cos_front, cos_back;
	float ox = r->ox[i], oy = r->oy[i], oz = r->oz[i] - k->sphere_z, dx = r->dx[i], dy = r->dy[i], dz = r->dz[i];
	float cornea = enter(&ray, k->front, g, &cos_front);
	float K[3] = { ray.o[0], ray.o[1], ray.o[2] };
	cornea = K[0] * K[0] + K[1] * K[1] <= k->rim2 ? cornea : 0;
	if (two)
		cornea *= enter(&ray, k->back, g, &cos_back);
	float unit = (1.5f - 0.5f * (dx * dx + dy * dy + dz * dz)) / k->index;
	float tk = (K[0] - ox) * dx + (K[1] - oy) * dy + (K[2] - k->sphere_z - oz) * dz;
	float b = ox * dx + oy * dy + oz * dz, disc = b * b - (ox * ox + oy * oy + oz * oz - k->sphere_r * k->sphere_r);
	float ts = -b - sqrtf(disc > 0 ? disc : 0), ball = disc > 0 && (cornea == 0 || ts < tk) ? 1.0f : 0.0f;
	float x = ball > 0 ? ox + ts * dx : K[0], y = ball > 0 ? oy + ts * dy : K[1], z = ball > 0 ? oz + ts * dz + k->sphere_z : K[2];
	float hit = ball > 0 ? 1 : cornea, fz = k->front.p * z - k->front.R, inv = 1 / sqrtf(x * x + y * y + fz * fz);
	float u = x * k->limbus[0], v = y * k->limbus[1], deep = z - k->sphere_z, rho = deep < 0 ? sqrtf(u * u + v * v) : 2;
	float blend = quick_ramp(LOOK_SEAM_FROM, (float)(1 / (LOOK_SEAM_TO - LOOK_SEAM_FROM)), rho), per = 1 / k->sphere_r;
	float nx = x * inv + blend * (x * per - x * inv), ny = y * inv + blend * (y * per - y * inv), nz = fz * inv + blend * (deep * per - fz * inv);
	float norm = 1 / sqrtf(nx * nx + ny * ny + nz * nz);
	float lid = quick_ramp(1 - 0.5f * k->lid_width, 1 / k->lid_width, rho), far = 1 / sqrtf(x * x + y * y + deep * deep);
	float place = angle_over_sine(-deep * far) * far * (float)(0.5 / SCENE_SCLERA_REACH);
	s->hit[i] = hit;
	s->nx[i] = hit > 0 ? nx * norm : 0;
	s->ny[i] = hit > 0 ? ny * norm : 0;
	s->nz[i] = hit > 0 ? nz * norm : -1;
	s->rho[i] = rho;
	s->lid[i] = hit > 0 ? cornea > 0 ? lid : 1 : 0;
	s->su[i] = x * place;
	s->sv[i] = y * place;
	s->fx[i] = ray.o[0];
	s->fy[i] = ray.o[1];
	s->fz[i] = ray.o[2];
	s->vx[i] = unit * ray.d[0];
	s->vy[i] = unit * ray.d[1];
	s->vz[i] = unit * ray.d[2];
}

#define QUICK_LOOP(name, lane)                                                                                         \
	SIMD_CLONES static void name(struct quick_spots *s, const struct quick_rays *r, const struct quick_look *k)        \
	{                                                                                                                  \
		SIMD_LOOP                                                                                                      \
		for (int i = 0; i < r->n; i++)                                                                                 \
			lane;                                                                                                      \
	}
QUICK_LOOP(outside_one, outside_lane(i, s, r, k, false))
QUICK_LOOP(outside_two, outside_lane(i, s, r, k, true))

void quick_outside(struct quick_spots *s, const struct quick_rays *r, const struct quick_look *k)
{
	(k->two ? outside_two : outside_one)(s, r, k);
}

/* Light in the white: diffuse below its film; next to the limbus it thins out over the dark of the chamber's angle. Then the ripples of
 * its film bend the normal. */
SIMD_CLONES void quick_sclera(float out[3][BATCH], int n, const float *restrict nx, const float *restrict ny, const float *restrict nz,
                              const float *restrict rho, const struct quick_look *k)
{
	static const float rim[3] = { LOOK_RIM_DARK };
	const float (*m)[3] = k->cam_from_eye;
	for (int c = 0; c < 3; c++) {
		const float *wet = &k->light->env->wet[0][c];
		float *restrict sky = out[c];
		SIMD_LOOP
		for (int i = 0; i < n; i++) {
			float x = nx[i], y = ny[i], z = nz[i], edge = 1 - quick_ramp(LOOK_RIM_FROM, (float)(1 / (LOOK_RIM_TO - LOOK_RIM_FROM)), rho[i]);
			float light = envmap_wet_at(wet, 3, m[0][0] * x + m[0][1] * y + m[0][2] * z, m[1][0] * x + m[1][1] * y + m[1][2] * z, m[2][0] * x + m[2][1] * y + m[2][2] * z);
			sky[i] = light * (1 - rim[c] * edge * edge);
		}
	}
}

/* Ripples of the tear film bend the normals beyond the limbus. */
SIMD_CLONES static void ripple(struct quick_found *f, int n, const struct quick_look *k)
{
	const struct image *film = &k->scene->film;
	const struct quick_spots *s = &f->spots;
	const float *restrict map = film->px, w = (float)film->width;
	int size = film->width;
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float x = s->nx[i] + channel_at(map, size, 1, s->su[i] * w, s->sv[i] * w, 2, 0);
		float y = s->ny[i] + channel_at(map, size, 1, s->su[i] * w, s->sv[i] * w, 2, 1), z = s->nz[i];
		float inv = 1 / sqrtf(x * x + y * y + z * z), on = s->rho[i] > 1 ? 1.0f : 0.0f;
		f->bent[0][i] = on > 0 ? x * inv : s->nx[i];
		f->bent[1][i] = on > 0 ? y * inv : s->ny[i];
		f->bent[2][i] = on > 0 ? z * inv : s->nz[i];
	}
}

void quick_bend(struct quick_found *f, int n, const struct quick_look *k)
{
	if (f->white) {
		ripple(f, n, k);
		return;
	}
	memcpy(f->bent[0], f->spots.nx, (size_t)n * sizeof(float));
	memcpy(f->bent[1], f->spots.ny, (size_t)n * sizeof(float));
	memcpy(f->bent[2], f->spots.nz, (size_t)n * sizeof(float));
}

/* The relief along each ray, by Newton's steps from the iris plane. */
SIMD_CLONES static void meet_straight(struct quick_spots *s, int n, const struct quick_look *k)
{
	enum { STEPS = 2 };
	const int *restrict pairs = k->level->pairs;
	const float *restrict fx = s->fx, *restrict fy = s->fy, *restrict fz = s->fz;
	const float *restrict vx = s->vx, *restrict vy = s->vy, *restrict vz = s->vz;
	float *restrict iu = s->iu, *restrict iv = s->iv, per_mm = k->level->per_mm, plane = (float)k->scene->eye.iris_depth;
	float most = plane - k->scene->height_min, least = plane - k->scene->height_max;
	int size = k->level->n;
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float x = fx[i] + k->slip[0][0] * fx[i] + k->slip[0][1] * fy[i] + k->slip[0][2];
		float y = fy[i] + k->slip[1][0] * fx[i] + k->slip[1][1] * fy[i] + k->slip[1][2];
		float a = vx[i] + k->slip[0][0] * vx[i] + k->slip[0][1] * vy[i], b = vy[i] + k->slip[1][0] * vx[i] + k->slip[1][1] * vy[i];
		float c = vz[i] > 0.1f ? vz[i] : 0.1f, low = (least - fz[i]) / c, high = (most - fz[i]) / c, t = (plane - fz[i]) / c;
#pragma GCC unroll 2
		for (int j = 0; j < STEPS; j++) {
			float gx, gy, f = fz[i] + t * c - plane + quick_height_at(pairs, size, per_mm, x + t * a, y + t * b, &gx, &gy);
			float slope = c + gx * a + gy * b;
			t -= f / (slope > 0.3f ? slope : 0.3f);
			t = t > low ? t < high ? t : high : low;
		}
		iu[i] = x + t * a;
		iv[i] = y + t * b;
	}
}

/* The same by a search for the first crossing, as the exact tracer does it. */
static void meet_leaning(struct quick_spots *s, int n, const struct quick_look *k)
{
	struct iris_batch b = { .n = n };
	for (int i = 0; i < n; i++) {
		bool seen = s->hit[i] > 0 && s->lid[i] < 1;
		float fx = seen ? s->fx[i] : 0, fy = seen ? s->fy[i] : 0, vx = seen ? s->vx[i] : 0, vy = seen ? s->vy[i] : 0;
		b.fx[i] = fx + k->slip[0][0] * fx + k->slip[0][1] * fy + k->slip[0][2];
		b.fy[i] = fy + k->slip[1][0] * fx + k->slip[1][1] * fy + k->slip[1][2];
		b.fz[i] = seen ? s->fz[i] : 0;
		b.vx[i] = vx + k->slip[0][0] * vx + k->slip[0][1] * vy;
		b.vy[i] = vy + k->slip[1][0] * vx + k->slip[1][1] * vy;
		b.vz[i] = seen ? fmaxf(s->vz[i], 0.1f) : 1;
	}
	scene_meet(&b, k->scene, k->level);
	memcpy(s->iu, b.px, (size_t)n * sizeof(float));
	memcpy(s->iv, b.py, (size_t)n * sizeof(float));
}

void quick_iris(struct quick_spots *s, const struct quick_rays *r, const struct quick_look *k)
{
	bool leans = false;
	for (int i = 0; i < r->n && !leans; i++)
		leans = s->hit[i] > 0 && s->lid[i] < 1 && quick_leans(s->vx[i], s->vy[i], s->vz[i]);
	(leans ? meet_leaning : meet_straight)(s, r->n, k);
}

SIMD_CLONES void quick_reflect(float *restrict out_x, float *restrict out_y, float *restrict out_z, struct quick_found *f, const struct quick_rays *r,
                               const struct quick_look *k)
{
	struct quick_spots *s = &f->spots;
	float(*m)[3] = (float(*)[3])k->cam_from_eye;
	SIMD_LOOP
	for (int i = 0; i < r->n; i++) {
		float dx = r->dx[i], dy = r->dy[i], dz = r->dz[i], nx = f->bent[0][i], ny = f->bent[1][i], nz = f->bent[2][i];
		float c = -(dx * nx + dy * ny + dz * nz), rx = dx + 2 * c * nx, ry = dy + 2 * c * ny, rz = dz + 2 * c * nz;
		s->mirror[i] = fresnel(c);
		// The film is smooth on the cornea, and lies on a rough ground beyond the limbus.
		s->rough[i] = (float)LOOK_FILM_ROUGH * quick_ramp(LOOK_FILM_FROM, (float)(1 / (LOOK_FILM_TO - LOOK_FILM_FROM)), s->rho[i]);
		out_x[i] = m[0][0] * rx + m[0][1] * ry + m[0][2] * rz;
		out_y[i] = m[1][0] * rx + m[1][1] * ry + m[1][2] * rz;
		out_z[i] = m[2][0] * rx + m[2][1] * ry + m[2][2] * rz;
	}
}

SIMD_CLONES void quick_unfold(int n, float *restrict x, float *restrict y, const float *restrict z)
{
	SIMD_LOOP
	for (int i = 0; i < n; i++) {
		float ax = x[i] < 0 ? -x[i] : x[i], ay = y[i] < 0 ? -y[i] : y[i], az = z[i] < 0 ? -z[i] : z[i], inv = 1 / (ax + ay + az);
		float fu = 1 - ay * inv, fv = 1 - ax * inv, u = x[i] * inv, v = y[i] * inv;
		x[i] = z[i] > 0 ? u < 0 ? -fu : fu : u;
		y[i] = z[i] > 0 ? v < 0 ? -fv : fv : v;
	}
}

struct quick_look quick_look(const struct scene *s, const struct scene_view *view, const struct scene_lighting *light, const struct scene_shade *shade, const struct scene_level *level)
{
	const struct cornea *c = &s->cornea;
	double n1 = c->two_surface ? c->n_cornea : c->n, m = c->n / n1, edge = cornea_edge(c);
	struct quick_look k = { .scene = s, .light = light, .shade = shade, .level = level, .two = c->two_surface };
	long coarse = level - s->level + 3;  // 2^3 is NODE_STEP
	k.smooth = s->level + (coarse < s->n_levels ? coarse : s->n_levels - 1);
	k.front = (struct quick_quadric){ (float)c->R, (float)c->p, 0, (float)(n1 * n1 - 1) };
	k.back = (struct quick_quadric){ (float)c->R_post, (float)c->p_post, (float)c->thickness, (float)(m * m - 1) };
	k.rim2 = (float)(edge * edge);
	k.index = (float)c->n;
	k.sphere_z = (float)s->sclera_z;
	k.sphere_r = (float)s->conf.sclera_radius;
	k.lid_width = (float)(s->conf.limbus_width / s->limbus[0]);
	for (int i = 0; i < 2; i++) {
		k.limbus[i] = (float)(1 / s->limbus[i]);
		for (int j = 0; j < 3; j++)
			k.slip[i][j] = (float)view->slip[i][j];
	}
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			k.cam_from_eye[i][j] = (float)view->cam_from_eye[i][j];
	return k;
}
