#include "export/eye_mesh.h"

#include <math.h>

#include "base/mem.h"
#include "draw/eye/sclera.h"
#include "draw/eye/surface.h"
#include "export/outside.h"

const char *const export_part_names[EXPORT_PARTS] = { "iris", "pupil_back", "sclera", "cornea" };
const double export_pupils[EXPORT_TARGETS] = { 1, 8 };
const double export_normal_scale = 0.5;
const char *const export_pupil_names[EXPORT_TARGETS] = { "pupil_1mm", "pupil_8mm" };

/* The lip: how far the margin turns under, backwards and outwards, mm: never seen, it closes the edge. The disc behind the pupil. */
static const double lip = 0.12, back = 1.2;

double export_iris_root(const struct scene *s)
{
	double R = s->conf.sclera_radius, z = s->sclera_z - s->eye.iris_depth, inside = sqrt(fmax(R * R - z * z, 0));
	return fmin(inside, s->extent * (1 - 1.0 / s->level[0].n));
}

double export_iris_extent(const struct scene *s)
{
	return s->extent;
}

double export_cornea_extent(const struct scene *s)
{
	return 1.02 * export_seam(s) * fmax(s->limbus[0], s->limbus[1]);
}

static void planar_uv(float uv[2], const double at[2], double extent)
{
	uv[0] = (float)(0.5 + at[0] / (2 * extent));
	uv[1] = (float)(0.5 + at[1] / (2 * extent));
}

static void around_of(double dir[2], int i, int around)
{
	dir[0] = cos(2 * M_PI * i / around);
	dir[1] = -sin(2 * M_PI * i / around);  // counter-clockwise with y up
}

/* One vertex of the iris: ring 0 is the lip's inner edge, ring 1 the pupil's margin, the last the root. */
static void iris_vertex(struct export_part *p, const struct scene *s, int ring, int rings, int i, int around)
{
	double dir[2], t = fmax(ring - 1, 0) / (double)(rings - 2), root = export_iris_root(s), at[2];
	int k = ring * around + i;
	around_of(dir, i, around);
	double r = (1 - t) * s->pupil[2] + t * root + (ring ? 0 : lip);
	for (int c = 0; c < 2; c++)
		at[c] = (1 - t) * s->pupil[c] + r * dir[c];
	double z = s->eye.iris_depth - scene_relief_height(s, at[0], at[1]) + (ring ? 0 : lip);
	export_point(p->x[k], s, (double[3]){ at[0], at[1], z });
	p->normal[k][2] = 1;
	p->tangent[k][0] = p->tangent[k][3] = 1;
	planar_uv(p->uv[k], at, s->extent);
	for (int m = 0; m < EXPORT_TARGETS; m++) {
		double grow = (1 - t) * (0.5 * export_pupils[m] - s->pupil[2]);
		p->target[m][k][0] = (float)(grow * dir[0]);
		p->target[m][k][1] = (float)(-grow * dir[1]);
	}
}

static struct export_part iris(const struct scene *s, const struct export_mesh_conf *conf)
{
	int rings = conf->iris_rings + 2, around = 2 * conf->around;
	struct export_part p = export_grid(rings, around, false, false);
	p.tangent = mem_new((size_t)p.n, sizeof *p.tangent);
	for (int m = 0; m < EXPORT_TARGETS; m++)
		p.target[m] = mem_new((size_t)p.n, sizeof *p.target[m]);
	for (int j = 0; j < rings; j++)
		for (int i = 0; i < around; i++)
			iris_vertex(&p, s, j, rings, i, around);
	return p;
}

static struct export_part dark_back(const struct scene *s, const struct export_mesh_conf *conf)
{
	struct export_part p = export_grid(2, conf->around / 4, true, false);
	for (int i = 0; i < p.n; i++) {
		double dir[2], r = i < p.n / 2 ? 0 : export_iris_root(s);
		around_of(dir, i % (conf->around / 4), conf->around / 4);
		export_point(p.x[i], s, (double[3]){ r * dir[0], r * dir[1], s->eye.iris_depth + back });
		p.normal[i][2] = 1;
	}
	return p;
}

static void sclera_vertex(struct export_part *p, int k, const struct scene *s, const double at[3])
{
	double n[3], flat = hypot(at[0], at[1]), angle = atan2(flat, s->sclera_z - at[2]), r = fmin(angle / SCENE_SCLERA_REACH, 1);
	double per = flat > 1e-9 ? r / flat : 0;
	export_normal(n, s, at);
	export_point(p->x[k], s, at);
	export_direction(p->normal[k], n);
	planar_uv(p->uv[k], (double[2]){ per * at[0], per * at[1] }, 1);
}

/* The first third of the rings climbs from the seam over the sulcus, by distance from the axis; the others go round to the back pole. */
static struct export_part sclera(const struct scene *s, const struct export_mesh_conf *conf)
{
	int rings = conf->iris_rings / 2, near = rings / 3, around = conf->around;
	struct export_part p = export_grid(rings, around, false, true);
	double seam = export_seam(s), end = fmax(1.25, seam + 0.05), R = s->conf.sclera_radius;
	for (int j = 0; j < rings; j++)
		for (int i = 0; i < around; i++) {
			double dir[2], at[3], rho = seam + (end - seam) * fmin(j / (double)near, 1);
			around_of(dir, i, around);
			export_front(at, s, rho * s->limbus[0] * dir[0], rho * s->limbus[1] * dir[1]);
			if (j > near) {
				double from = atan2(hypot(at[0], at[1]), s->sclera_z - at[2]), azimuth = atan2(at[1], at[0]);
				double a = from + (M_PI - from) * (j - near) / (double)(rings - 1 - near);
				at[0] = R * sin(a) * cos(azimuth);
				at[1] = R * sin(a) * sin(azimuth);
				at[2] = s->sclera_z - R * cos(a);
			}
			sclera_vertex(&p, j * around + i, s, at);
		}
	return p;
}

static struct export_part cornea(const struct scene *s, const struct export_mesh_conf *conf)
{
	int rings = conf->iris_rings / 2, around = conf->around;
	struct export_part p = export_grid(rings, around, true, false);
	for (int j = 0; j < rings; j++)
		for (int i = 0; i < around; i++) {
			double dir[2], at[3], n[3], rho = export_seam(s) * j / (double)(rings - 1);
			int k = j * around + i;
			around_of(dir, i, around);
			export_front(at, s, rho * s->limbus[0] * dir[0], rho * s->limbus[1] * dir[1]);
			export_normal(n, s, at);
			export_point(p.x[k], s, at);
			export_direction(p.normal[k], n);
			planar_uv(p.uv[k], at, export_cornea_extent(s));
		}
	return p;
}

void export_eye_meshes(struct export_part parts[EXPORT_PARTS], const struct scene *s, const struct export_mesh_conf *conf)
{
	parts[EXPORT_IRIS] = iris(s, conf);
	parts[EXPORT_BACK] = dark_back(s, conf);
	parts[EXPORT_SCLERA] = sclera(s, conf);
	parts[EXPORT_CORNEA] = cornea(s, conf);
}
