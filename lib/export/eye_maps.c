#include "export/eye_maps.h"

#include <math.h>
#include <string.h>

#include "bridge/cv_blur.h"
#include "draw/eye/albedo.h"
#include "draw/eye/look.h"
#include "draw/eye/pupil.h"
#include "draw/eye/sclera.h"
#include "draw/smooth.h"
#include "export/eye_mesh.h"
#include "export/outside.h"
#include "math/vec.h"

const char *const export_map_names[EXPORT_MAPS] = { "iris_albedo", "iris_normal", "iris_height", "iris_thickness", "iris_freckles", "sclera_albedo",
	                                                "sclera_normal", "sclera_vessels", "sclera_roughness", "cornea_colour", "cornea_clear",
	                                                "cornea_depth", "cornea_roughness" };
const int export_map_channels[EXPORT_MAPS] = { 3, 3, 1, 1, 1, 3, 3, 1, 1, 3, 1, 1, 1 };

/* The map resampled to px; takes it over. */
static bool sized(struct image *out, struct image *map, int px, struct err *err)
{
	*out = image_new(px, px, map->channels);
	bool ok = cv_resize(out->px, px, px, map->px, map->width, map->height, map->channels, err);
	image_free(map);
	return ok;
}

/* The ruff darkens the colour; inside the pupil there is no iris, and its margin's colour goes on, so that no filter mixes in black. */
static void add_ruff(struct image *albedo, const struct scene *s)
{
	double mm = 2 * s->extent / albedo->width;
	struct image plain = image_new(albedo->width, albedo->height, 3);
	memcpy(plain.px, albedo->px, 3 * (size_t)plain.width * (size_t)plain.height * sizeof *plain.px);
#pragma omp parallel for schedule(dynamic, 16)
	for (int y = 0; y < albedo->height; y++)
		for (int x = 0; x < albedo->width; x++) {
			double u = (x + 0.5) * mm - s->extent - s->pupil[0], v = (y + 0.5) * mm - s->extent - s->pupil[1], r = hypot(u, v);
			if (r > s->pupil[2] + 0.3)
				continue;
			double k = r < s->pupil[2] + 0.5 * mm ? (s->pupil[2] + 0.5 * mm) / fmax(r, 1e-6) : 1;
			float cover[3], *rgb = image_at(albedo, x, y);
			scene_pupil(cover, s, (float)(s->pupil[0] + k * u), (float)(s->pupil[1] + k * v), (float)(0.5 * mm));
			for (int c = 0; c < 3; c++) {
				if (k > 1)
					rgb[c] = image_sample(&plain, (s->pupil[0] + k * u + s->extent) / mm, (s->pupil[1] + k * v + s->extent) / mm, c);
				rgb[c] *= cover[c];
			}
		}
	image_free(&plain);
}

/* Height, thickness and normal of the relief, at level 0's texels. */
static void relief_maps(struct image *height, struct image *thickness, struct image *normal, const struct scene *s)
{
	const struct scene_level *l = &s->level[0];
	int n = l->n;
	*height = image_new(n, n, 1);
	*thickness = image_new(n, n, 1);
	*normal = image_new(n, n, 3);
	for (int y = 0; y < n; y++)
		for (int x = 0; x < n; x++) {
			long at = (long)y * n + x, left = at - (x > 0), right = at + (x < n - 1), up = at - (y > 0 ? n : 0), down = at + (y < n - 1 ? n : 0);
			double gx = (l->relief[2 * right] - l->relief[2 * left]) * l->per_mm / (double)(right - left);
			double gy = (l->relief[2 * down] - l->relief[2 * up]) * l->per_mm * n / (double)(down - up), v[3] = { -gx, gy, 1 };
			height->px[at] = l->relief[2 * at];
			thickness->px[at] = l->relief[2 * at + 1];
			vec_unit(v, v);
			for (int c = 0; c < 3; c++)
				normal->px[3 * at + c] = (float)v[c];
		}
}

/* GGX roughness whose half-vectors spread as the blurred copy of an environment (6 degrees of reflection, 3 of normals) does, for a share
 * of it. */
static float film_roughness(double rho)
{
	double alpha = M_SQRT2 * tan(3 * M_PI / 180) * LOOK_FILM_ROUGH * smooth((float)LOOK_FILM_FROM, (float)LOOK_FILM_TO, (float)rho);
	return (float)sqrt(alpha);
}

/* What the sclera looks like at a point of its surface: albedo with the dark rim; normal: that of the rippled film. */
static void white_at(float rgb[3], double normal[3], const struct scene *s, const double at[3])
{
	static const float rim[3] = { LOOK_RIM_DARK };
	double rho = at[2] < s->sclera_z ? export_rho(s, at[0], at[1]) : 2, n[3];
	export_normal(n, s, at);
	float bent[3] = { (float)n[0], (float)n[1], (float)n[2] }, edge = 1 - smooth((float)LOOK_RIM_FROM, (float)LOOK_RIM_TO, (float)rho);
	scene_sclera(rgb, bent, s, (float[3]){ (float)at[0], (float)at[1], (float)at[2] });
	for (int c = 0; c < 3; c++) {
		rgb[c] *= 1 - rim[c] * edge * edge;
		normal[c] = bent[c];
	}
}

/* The outer surface's point in direction (angle from the axis, azimuth) of the sphere's centre: the sphere, or what stands before it. */
static void point_at_angle(double at[3], const struct scene *s, double angle, const double dir[2])
{
	double R = s->conf.sclera_radius, r = R * sin(angle);
	if (angle < 0.6 && r / fmin(s->limbus[0], s->limbus[1]) < 1.3)
		export_front(at, s, r * dir[0], r * dir[1]);
	else {
		at[0] = r * dir[0];
		at[1] = r * dir[1];
		at[2] = s->sclera_z - R * cos(angle);
	}
}

/* Basis of a point of the sphere for its normal map: T along rising u, made perpendicular to N; glTF's axes. */
static void sclera_tangent(double T[3], const double N[3], const double out[3])
{
	// Equidistant map: (u, v) = angle / reach (cos, -sin of the azimuth). Rising u at an azimuth is outwards times its cosine, and
	// sideways times its sine over the stretch sin(angle) / angle.
	double flat = hypot(out[0], out[1]), angle = atan2(flat, out[2]), c = flat > 1e-9 ? out[0] / flat : 1, d = flat > 1e-9 ? out[1] / flat : 0;
	double along[3] = { c * cos(angle), d * cos(angle), -sin(angle) }, side[3] = { -d, c, 0 };
	double stretch = angle > 1e-6 ? sin(angle) / angle : 1, dot = 0;
	for (int i = 0; i < 3; i++) {
		T[i] = c * along[i] - d * stretch * side[i];
		dot += T[i] * N[i];
	}
	for (int i = 0; i < 3; i++)
		T[i] -= dot * N[i];
	vec_unit(T, T);
}

/* The point that a texel of a map of the sclera shows. */
static void sclera_point(double at[3], const struct scene *s, const struct image *map, int x, int y)
{
	double u = (x + 0.5) / map->width * 2 - 1, v = (y + 0.5) / map->width * 2 - 1, r = hypot(u, v);
	point_at_angle(at, s, fmin(r * SCENE_SCLERA_REACH, M_PI), (double[2]){ r > 0 ? u / r : 1, r > 0 ? v / r : 0 });
}

static void sclera_texel(struct image maps[EXPORT_MAPS], const struct scene *s, int x, int y)
{
	double at[3], bent[3];
	sclera_point(at, s, &maps[EXPORT_SCLERA_ALBEDO], x, y);
	white_at(image_at(&maps[EXPORT_SCLERA_ALBEDO], x, y), bent, s, at);
}

static void ripple_texel(struct image maps[EXPORT_MAPS], const struct scene *s, int x, int y)
{
	double at[3], bent[3], n[3], T[3], B[3], N[3];
	float *normal = image_at(&maps[EXPORT_SCLERA_NORMAL], x, y), g[3], plain[3], out[3], rgb[3];
	sclera_point(at, s, &maps[EXPORT_SCLERA_NORMAL], x, y);
	white_at(rgb, bent, s, at);
	export_normal(n, s, at);
	export_point(g, s, at);
	export_direction(plain, n);
	export_direction(out, bent);
	for (int c = 0; c < 3; c++)
		N[c] = plain[c];
	sclera_tangent(T, N, (double[3]){ g[0], g[1], g[2] });
	vec_cross(B, N, T);
	for (int c = 0; c < 3; c++) {
		normal[0] += (float)T[c] * out[c];
		normal[1] += (float)B[c] * out[c];
		normal[2] += (float)N[c] * out[c];
	}
}

/* The map of vessels that the sclera's colour was made with. */
static struct image vessels(const struct scene *s)
{
	struct image out = image_new(s->veins.width, s->veins.height, 1);
	for (long i = 0; i < (long)out.width * out.height; i++)
		out.px[i] = s->veins.px[4 * i + 3];
	return out;
}

/* Mean albedo of the iris inside the limbus. */
static void outer_iris(float rgb[3], const struct image *albedo, const struct scene *s)
{
	double sum[3] = { 0 }, mm = 2 * s->extent / albedo->width;
	long n = 0;
	for (int y = 0; y < albedo->height; y++)
		for (int x = 0; x < albedo->width; x++) {
			const double rho = export_rho(s, (x + 0.5) * mm - s->extent, (y + 0.5) * mm - s->extent);
			if (rho < 0.85 || rho > 0.97)
				continue;
			for (int c = 0; c < 3; c++)
				sum[c] += image_at(albedo, x, y)[c];
			n++;
		}
	for (int c = 0; c < 3; c++)
		rgb[c] = n ? (float)(sum[c] / (double)n) : 0;
}

static void cornea_texel(struct image maps[EXPORT_MAPS], const struct scene *s, int x, int y)
{
	struct image *colour = &maps[EXPORT_CORNEA_COLOUR];
	double e = export_cornea_extent(s), u = ((x + 0.5) / colour->width * 2 - 1) * e, v = ((y + 0.5) / colour->width * 2 - 1) * e, rho = export_rho(s, u, v);
	double at[3], n[3], in[3];
	float share = (float)export_white(s, rho);
	export_front(at, s, u, v);
	white_at(image_at(colour, x, y), n, s, at);
	*image_at(&maps[EXPORT_CORNEA_CLEAR], x, y) = 1 - share;
	export_normal(n, s, at);
	bool ok = refract(in, (double[3]){ 0, 0, 1 }, n, 1, s->cornea.n) && in[2] > 0;
	*image_at(&maps[EXPORT_CORNEA_DEPTH], x, y) = (float)(ok ? fmax((s->eye.iris_depth - at[2]) / in[2], 0) : 0);
}

/* A material has one colour for what it scatters and what goes through: where it does both, the two together become as bright as sclera and clear glass before that
 * iris are, in light that is the same on both. */
static void join_colours(struct image maps[EXPORT_MAPS], const struct scene *s)
{
	float iris[3];
	outer_iris(iris, &maps[EXPORT_IRIS_ALBEDO], s);
	struct image *colour = &maps[EXPORT_CORNEA_COLOUR], *clear = &maps[EXPORT_CORNEA_CLEAR];
	for (long i = 0; i < (long)colour->width * colour->height; i++)
		for (int c = 0; c < 3; c++) {
			float *rgb = colour->px + 3 * i + c, through = clear->px[i] * iris[c];
			*rgb += (1 - *rgb) * through / fmaxf(1 - clear->px[i] + through, 1e-6f);
		}
}

static void rough_texel(struct image maps[EXPORT_MAPS], const struct scene *s, int x, int y)
{
	struct image *cornea = &maps[EXPORT_CORNEA_ROUGHNESS], *sclera = &maps[EXPORT_SCLERA_ROUGHNESS];
	double u = (x + 0.5) / cornea->width * 2 - 1, v = (y + 0.5) / cornea->width * 2 - 1, e = export_cornea_extent(s), at[3];
	*image_at(cornea, x, y) = film_roughness(export_rho(s, e * u, e * v));
	sclera_point(at, s, sclera, x, y);
	*image_at(sclera, x, y) = film_roughness(at[2] < s->sclera_z ? export_rho(s, at[0], at[1]) : 2);
}

static void each_texel(struct image maps[EXPORT_MAPS], enum export_map of, const struct scene *s,
                       void (*fill)(struct image maps[EXPORT_MAPS], const struct scene *s, int x, int y))
{
#pragma omp parallel for schedule(dynamic, 8)
	for (int y = 0; y < maps[of].height; y++)
		for (int x = 0; x < maps[of].width; x++)
			fill(maps, s, x, y);
}

static void renormalise(struct image *normal)
{
	for (long i = 0; i < (long)normal->width * normal->height; i++) {
		float *p = normal->px + 3 * i, len = sqrtf(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
		for (int c = 0; c < 3; c++)
			p[c] /= len;
	}
}

/* The power of two that holds n texels, most at the most. */
static int holds(int n, int most)
{
	int px = 1;
	while (px < n && 2 * px <= most)
		px *= 2;
	return px;
}

bool export_eye_maps(struct image maps[EXPORT_MAPS], const struct scene *s, const struct image *freckles, const struct envmap *lit, int most,
                     struct err *err)
{
	int px = holds(s->level[0].n, most), white = holds(s->veins.width, most);
	struct image albedo = scene_albedo(s, lit), veins = vessels(s), height, thickness, normal;
	relief_maps(&height, &thickness, &normal, s);
	for (int i = 0; i < EXPORT_MAPS; i++)
		maps[i] = (struct image){ 0 };
	// Each takes what it is given, so that all are called.
	bool ok = sized(&maps[EXPORT_IRIS_ALBEDO], &albedo, px, err);
	ok &= sized(&maps[EXPORT_IRIS_NORMAL], &normal, px, err);
	ok &= sized(&maps[EXPORT_IRIS_HEIGHT], &height, px, err);
	ok &= sized(&maps[EXPORT_IRIS_THICKNESS], &thickness, px, err);
	ok &= sized(&maps[EXPORT_SCLERA_VESSELS], &veins, white, err);
	maps[EXPORT_IRIS_FRECKLES] = image_new(px, px, 1);
	if (freckles)
		ok &= cv_resize(maps[EXPORT_IRIS_FRECKLES].px, px, px, freckles->px, freckles->width, freckles->height, 1, err);
	if (!ok)
		return false;
	add_ruff(&maps[EXPORT_IRIS_ALBEDO], s);
	renormalise(&maps[EXPORT_IRIS_NORMAL]);
	for (int i = EXPORT_SCLERA_ALBEDO; i < EXPORT_MAPS; i++)
		if (!maps[i].px) {
			bool rough = i == EXPORT_SCLERA_ROUGHNESS || i == EXPORT_CORNEA_ROUGHNESS || i == EXPORT_SCLERA_NORMAL;
			int n = rough ? white / 4 : i >= EXPORT_CORNEA_COLOUR ? white / 2 : white;
			maps[i] = image_new(n, n, export_map_channels[i]);
		}
	each_texel(maps, EXPORT_SCLERA_ALBEDO, s, sclera_texel);
	each_texel(maps, EXPORT_SCLERA_NORMAL, s, ripple_texel);
	each_texel(maps, EXPORT_CORNEA_COLOUR, s, cornea_texel);
	join_colours(maps, s);
	each_texel(maps, EXPORT_SCLERA_ROUGHNESS, s, rough_texel);
	return true;
}
