/* lids: measures a driven character's lids on its mesh, seen orthographically from the front.
 *   lids RIG.npz [FOLDER]   one line of numbers a pose and side on stdout; FOLDER: a picture of each pose, PGM, the eyeball white
 *   lids RIG.npz expressions H V   the same of eyes that look so (degrees), without expression (-1) and with each in full, open as usual and shut, instead of gazes
 * open_mm2   area of the eyeball that is seen
 * bend_mm    how far the upper margin, found by rays in columns 0.1 mm apart, leaves the nearer of its convex and its concave hull: 0 where its curvature has one
 *            sign. It ends where it is behind skin: at steps of more than 0.5 mm within an eighth of its length from an end
 * inside_mm  least distance of the skin's vertices from the turned eyeball; below 0: inside
 * faces_mm   the same of points on edges and faces that look outwards before it
 * crossing   of a hundred lashes of an upper lid and sixty of a lower one, those that skin crosses
 * thick_least, thick_mid   of both lids' margins, between the corners' tenths: from where the front sees the eyeball end to where, within 3 mm, skin last rises off it by
 *            half of the way along it: the margin's outer edge, beyond what lines the lid; mm of an eyeball of 12 mm, the least and the median; below 0: the skin that ends there lies lower than the
 *            eyeball. Nothing in eyes that are open by less than 1 mm
 * lining_mm  of columns 0.5 mm apart, but for 1.5 mm at each end, the most of skin next to the upper margin that at rest looks at the eyeball, mm: what lines the
 *            lid, come before its margin
 * iris_low, pupil_low   share of iris and pupil (5.7 and 2 mm on an eyeball of 12 mm) that lies under the lower lid */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/vec.h"
#include "mesh/ray.h"
#include "rig/deform/arc.h"
#include "rig/deform/deform.h"
#include "rig/deform/lifted.h"
#include "rig/drive.h"
#include "rig/hair/hair.h"

enum { W = 480, H = 320 };
static const double step = 0.1;  // mm a pixel

/* What is seen of one eye: depth and the face there, -1: none. */
struct seen {
	double z[W * H];
	int face[W * H];
};

static void into_head(double out[3], const struct rig *rig, int side, const float x[3])
{
	double d[3];
	for (int c = 0; c < 3; c++)
		d[c] = x[c] - rig->globe[side].center[c];
	mat_vec(out, rig->head_from_target, d);
}

static void draw(struct seen *s, int face, const double p[3][3])
{
	double q[3][2], area;
	for (int k = 0; k < 3; k++) {
		q[k][0] = p[k][0] / step + W / 2;
		q[k][1] = H / 2 - p[k][1] / step;
	}
	area = (q[1][0] - q[0][0]) * (q[2][1] - q[0][1]) - (q[1][1] - q[0][1]) * (q[2][0] - q[0][0]);
	if (area == 0)
		return;
	int x0 = (int)fmax(floor(fmin(fmin(q[0][0], q[1][0]), q[2][0])), 0), x1 = (int)fmin(ceil(fmax(fmax(q[0][0], q[1][0]), q[2][0])), W - 1);
	int y0 = (int)fmax(floor(fmin(fmin(q[0][1], q[1][1]), q[2][1])), 0), y1 = (int)fmin(ceil(fmax(fmax(q[0][1], q[1][1]), q[2][1])), H - 1);
	for (int y = y0; y <= y1; y++)
		for (int x = x0; x <= x1; x++) {
			double px = x + 0.5, py = y + 0.5, w[3], z = 0;
			w[0] = ((q[2][0] - q[1][0]) * (py - q[1][1]) - (q[2][1] - q[1][1]) * (px - q[1][0])) / area;
			w[1] = ((q[0][0] - q[2][0]) * (py - q[2][1]) - (q[0][1] - q[2][1]) * (px - q[2][0])) / area;
			w[2] = 1 - w[0] - w[1];
			if (w[0] < -1e-9 || w[1] < -1e-9 || w[2] < -1e-9)
				continue;
			for (int k = 0; k < 3; k++)
				z += w[k] * p[k][2];
			if (z > s->z[y * W + x]) {
				s->z[y * W + x] = z;
				s->face[y * W + x] = face;
			}
		}
}

static void look(struct seen *s, const struct rig *rig, int side, const float (*x)[3])
{
	for (int i = 0; i < W * H; i++) {
		s->z[i] = -1e9;
		s->face[i] = -1;
	}
	for (int f = 0; f < rig->n_faces; f++) {
		double p[3][3];
		for (int k = 0; k < 3; k++)
			into_head(p[k], rig, side, x[rig->faces[f][k]]);
		draw(s, f, (const double(*)[3])p);
	}
}

/* Largest distance of a chain below its upper hull; y: [n], NAN where there is none. */
static double below_hull(int n, const double *y)
{
	double worst = 0;
	for (int i = 0; i < n; i++)
		for (int a = 0; a < i && isfinite(y[i]); a++)
			for (int b = i + 1; b < n && isfinite(y[a]); b++)
				if (isfinite(y[b]))
					worst = fmax(worst, y[a] + (y[b] - y[a]) * (i - a) / (b - a) - y[i]);
	return worst;
}

/* A pose: its vertices, its faces for rays. */
struct pose {
	const struct rig *rig;
	const float (*x)[3];
	const struct ray_scene *all;
	const double (*turn)[3][3];
	const int32_t (*skin_and_globes)[3];   // the faces of all
};

/* The first surface of a scene that the front sees at a place before an eyeball's centre, mm; at: out, where that is, the character's axes. Face < 0: none. */
static struct ray_hit from_front(float at[3], const struct pose *p, const struct ray_scene *scene, int side, double x, double y)
{
	const double far = 4 * p->rig->globe[side].radius;
	double from[3], along[3];
	float origin[3], dir[3];
	mat_tvec(from, p->rig->head_from_target, (double[]){ x, y, far });
	mat_tvec(along, p->rig->head_from_target, (double[]){ 0, 0, -1 });
	for (int c = 0; c < 3; c++) {
		origin[c] = (float)(p->rig->globe[side].center[c] + from[c]);
		dir[c] = (float)along[c];
	}
	const struct ray_hit hit = ray_first(scene, origin, dir, 0, (float)(2 * far));
	for (int c = 0; c < 3; c++)
		at[c] = origin[c] + hit.t * dir[c];
	return hit;
}

static bool open_at(const struct pose *p, int side, double x, double y)
{
	float at[3];
	const struct ray_hit hit = from_front(at, p, p->all, side, x, y);
	return hit.face >= 0 && rig_is_globe(p->rig->part[p->skin_and_globes[hit.face][0]]);
}

static double edge_at(const struct pose *p, int side, double x, double open, double shut)
{
	while (fabs(open - shut) > 0.002) {
		const double middle = 0.5 * (open + shut);
		if (open_at(p, side, x, middle))
			open = middle;
		else
			shut = middle;
	}
	return open;
}

/* The lids' margins in columns, mm; NAN where there is no opening. */
struct margins {
	double top[W], bottom[W];
};

static void find_margins(struct margins *m, const struct pose *p, int side)
{
	static const double row = 0.2, high = 13;
	for (int i = 0; i < W; i++) {
		const double x = step * (i - W / 2);
		int best = 0, at = 0, run = 0;
		for (int k = 0; high - row * k > -high; k++) {
			const bool open = open_at(p, side, x, high - row * k);
			run = open ? run + 1 : 0;
			at = run > best ? k : at;
			best = run > best ? run : best;
		}
		const double top = high - row * (at - best + 1), bottom = high - row * at;
		m->top[i] = best ? edge_at(p, side, x, top, top + row) : NAN;
		m->bottom[i] = best ? edge_at(p, side, x, bottom, bottom - row) : NAN;
	}
}

/* What lies beyond a step near an end is a corner behind the margin. */
static void end_at_steps(double *y, int n)
{
	int first = 0, last = n - 1;
	while (first < n && isnan(y[first]))
		first++;
	while (last > first && isnan(y[last]))
		last--;
	const int eighth = (last - first) / 8;
	for (int i = first; i < first + eighth; i++)
		if (fabs(y[i + 1] - y[i]) > 0.5)
			for (int k = first; k <= i; k++)
				y[k] = NAN;
	for (int i = last; i > last - eighth; i--)
		if (fabs(y[i - 1] - y[i]) > 0.5)
			for (int k = i; k <= last; k++)
				y[k] = NAN;
}

static double bend_of(const struct margins *m)
{
	double y[W], down[W];
	memcpy(y, m->top, sizeof y);
	end_at_steps(y, W);
	for (int i = 0; i < W; i++)
		down[i] = -y[i];
	return fmin(below_hull(W, y), below_hull(W, down));
}

/* The first surface that the front sees at a place: the point in the head's axes; its height over the turned eyeball. False: none. */
static bool seen_at(double at[3], double *height, const struct pose *p, const struct ray_scene *scene, int side, double x, double y)
{
	float hit_at[3];
	if (from_front(hit_at, p, scene, side, x, y).face < 0)
		return false;
	into_head(at, p->rig, side, hit_at);
	*height = rig_globe_distance(p->rig, side, p->turn[side], hit_at);
	return true;
}

/* How thick a margin is in a column: NAN where its outer edge is not found. out: 1 upwards. */
static double thickness_at(const struct pose *p, const struct ray_scene *skin, int side, double x, double edge, int out)
{
	enum { STEPS = 60, AHEAD = 6 };
	const double unit = p->rig->globe[side].radius / 12, fine = 0.05 * unit;
	double inner[3], at[STEPS][3], height[STEPS], off;
	int outer = 0;
	if (!seen_at(inner, &off, p, p->all, side, x, edge))
		return NAN;
	for (int k = 0; k < STEPS; k++) {
		if (!seen_at(at[k], &height[k], p, skin, side, x, edge + out * (0.2 + k) * fine))
			return NAN;
		if (k < AHEAD)
			continue;
		const int from = k - AHEAD;
		double d[3];
		vec_add(d, at[k], -1, at[from]);
		outer = height[k] - height[from] < 0.5 * vec_norm(d) ? outer : k;
	}
	double d[3];
	vec_add(d, at[outer], -1, inner);
	return (height[outer] < off - 0.05 ? -1 : 1) * vec_norm(d) / unit;
}

/* Whether the front sees at a place what at rest looks at the eyeball. */
static bool lines_lid(const struct pose *p, int side, double x, double y)
{
	float at[3];
	double e[2][3], normal[3], away[3] = { 0 };
	const struct ray_hit hit = from_front(at, p, p->all, side, x, y);
	if (hit.face < 0 || rig_is_globe(p->rig->part[p->skin_and_globes[hit.face][0]]))
		return false;
	const int32_t *v = p->skin_and_globes[hit.face];
	for (int c = 0; c < 3; c++) {
		for (int k = 0; k < 2; k++)
			e[k][c] = (double)p->rig->rest[v[k + 1]][c] - (double)p->rig->rest[v[0]][c];
		for (int k = 0; k < 3; k++)
			away[c] += (double)p->rig->rest[v[k]][c] / 3;
		away[c] -= p->rig->globe[side].center[c];
	}
	vec_cross(normal, e[0], e[1]);
	return vec_dot(normal, away) < -0.5 * vec_norm(normal) * vec_norm(away);
}

/* Most of what lines the upper lid and is seen below its margin. */
static double lining_seen(const struct margins *m, const struct pose *p, int side)
{
	static const double fine = 0.05, most_mm = 4;
	const int every = (int)lrint(0.5 / step), ends = (int)lrint(1.5 / step);
	double most = 0;
	for (int i = ends; i + ends < W; i += every) {
		if (!isfinite(m->top[i] + m->top[i - ends] + m->top[i + ends]))
			continue;
		double by = fine;
		while (by < most_mm && lines_lid(p, side, step * (i - W / 2), m->top[i] + by))
			by += fine;
		most = fmax(most, by - fine);
	}
	return most;
}

static int rising(const void *a, const void *b)
{
	const double p = *(const double *)a, q = *(const double *)b;
	return (p > q) - (p < q);
}

/* least, middle: out; NAN where there are none. */
static void thicknesses(double *least, double *middle, const struct margins *m, const struct pose *p, const struct ray_scene *skin, int side)
{
	double t[2 * W], most = 0;
	int first = W, last = -1, n = 0;
	for (int i = 0; i < W; i++)
		if (isfinite(m->top[i])) {
			first = i < first ? i : first;
			last = i;
			most = fmax(most, m->top[i] - m->bottom[i]);
		}
	const int tenth = (last - first) / 10;
	for (int i = first + tenth; i <= last - tenth && most > 1; i++)
		for (int upper = 0; upper < 2 && isfinite(m->top[i]); upper++) {
			const double at = thickness_at(p, skin, side, step * (i - W / 2), upper ? m->top[i] : m->bottom[i], upper ? 1 : -1);
			if (isfinite(at))
				t[n++] = at;
		}
	qsort(t, (size_t)n, sizeof *t, rising);
	*least = n ? t[0] : NAN;
	*middle = n ? t[n / 2] : NAN;
}

/* Share of a disc across the eye's axis, of that radius, mm of an eyeball of 12 mm, that lies under the lower lid. */
static double under_lower(const struct margins *m, const struct pose *p, int side, double radius)
{
	const double unit = p->rig->globe[side].radius / 12;
	double under = 0, all = 0;
	for (int ring = 1; ring <= 12; ring++)
		for (int k = 0; k < 60; k++) {
			const double r = radius * ring / 12, a = 2 * M_PI * k / 60;
			double target[3], head[3];
			mat_vec(target, p->turn[side], (double[]){ unit * r * cos(a), unit * r * sin(a), unit * sqrt(144 - radius * radius) });
			mat_vec(head, p->rig->head_from_target, target);
			const int i = (int)fmin(fmax(lrint(head[0] / step) + W / 2, 0), W - 1);
			under += head[1] < m->bottom[i] ? r : 0;
			all += r;
		}
	return under / all;
}

/* Least distance from the turned eyeball of skin that looks outwards before it, on edges and faces. */
static double faces_off(const struct pose *p, int side)
{
	enum { PARTS = 4 };
	const struct rig *rig = p->rig;
	double least = INFINITY;
	for (int f = 0; f < rig->n_faces; f++) {
		const int32_t *v = rig->faces[f];
		double h[3][3], a[3], b[3], n[3], middle[3];
		bool near = true;
		for (int k = 0; k < 3; k++) {
			into_head(h[k], rig, side, p->x[v[k]]);
			near = near && rig->part[v[k]] == RIG_SKIN && rig->side[v[k]] == side && h[k][2] > 0.2 * rig->globe[side].radius && vec_norm(h[k]) < 1.4 * rig->globe[side].radius;
		}
		for (int c = 0; c < 3; c++) {
			a[c] = h[1][c] - h[0][c];
			b[c] = h[2][c] - h[0][c];
			middle[c] = h[0][c] + h[1][c] + h[2][c];
		}
		vec_cross(n, a, b);
		if (!near || !(vec_dot(n, middle) > 0.3 * vec_norm(n) * vec_norm(middle)))
			continue;
		for (int i = 0; i <= PARTS; i++)
			for (int j = 0; i + j <= PARTS; j++) {
				float at[3];
				for (int c = 0; c < 3; c++)
					at[c] = (p->x[v[0]][c] * (float)i + p->x[v[1]][c] * (float)j + p->x[v[2]][c] * (float)(PARTS - i - j)) / PARTS;
				least = fmin(least, rig_globe_distance(rig, side, p->turn[side], at));
			}
	}
	return least;
}

/* Lashes of an eye that skin crosses beyond their roots' first piece. */
static int crossing(const struct hairs *h, const struct pose *p, const struct ray_scene *skin, int side)
{
	int n = 0;
	for (int i = 0; i < h->n; i++) {
		const struct hair *hair = &h->hair[i];
		float at[HAIR_LASH_POINTS][3];
		bool crossed = false;
		if (hair->kind == HAIR_BROW || hair->side != side)
			continue;
		hair_place(at, h, hair, p->rig, p->x);
		for (int k = 1; k + 1 < hair->n; k++) {
			float dir[3] = { at[k + 1][0] - at[k][0], at[k + 1][1] - at[k][1], at[k + 1][2] - at[k][2] };
			crossed = crossed || ray_blocked(skin, at[k], dir, 0, 1);
		}
		n += crossed;
	}
	return n;
}

static void picture(const char *folder, const char *name, const struct seen *s, const struct rig *rig)
{
	char path[4096];
	snprintf(path, sizeof path, "%s/%s.pgm", folder, name);
	FILE *f = fopen(path, "wb");
	if (!f)
		return;
	fprintf(f, "P5 %d %d 255\n", W, H);
	for (int i = 0; i < W * H; i++) {
		double gx = i % W ? (s->z[i] - s->z[i - 1]) / step : 0, gy = i >= W ? (s->z[i] - s->z[i - W]) / step : 0;
		bool globe = s->face[i] >= 0 && rig_is_globe(rig->part[rig->faces[s->face[i]][0]]);
		double light = globe ? 255 : 40 + 160 * (1 - 0.5 * gx + 0.7 * gy) / sqrt(1 + gx * gx + gy * gy) / 1.4;
		fputc((int)fmin(fmax(light, 0), 255), f);
	}
	fclose(f);
}

/* faces: out, [rig.n_faces]. The skin alone, for rays; or it and the eyeballs, without lining: caruncles hide no margin. */
static struct ray_scene *skin_of(int32_t (*faces)[3], const struct rig *rig, bool globes)
{
	int n = 0;
	for (int f = 0; f < rig->n_faces; f++)
		if (rig->part[rig->faces[f][0]] == RIG_SKIN || (globes && rig_is_globe(rig->part[rig->faces[f][0]])))
			memcpy(faces[n++], rig->faces[f], sizeof *faces);
	return ray_scene_new(rig->n, (const float(*)[3])rig->rest, n, (const int32_t(*)[3])faces);
}

static double vertices_off(const struct pose *p, int side)
{
	double least = INFINITY;
	for (int i = 0; i < p->rig->n; i++)
		if (!rig_is_globe(p->rig->part[i]) && p->rig->side[i] == side)
			least = fmin(least, rig_globe_distance(p->rig, side, p->turn[side], p->x[i]));
	return least;
}

static void measure(const struct pose *p, const struct ray_scene *skin, const struct hairs *hairs, int side, const char *at, const char *folder)
{
	struct seen *s = mem_new(1, sizeof *s);
	struct margins m;
	int n = 0;
	look(s, p->rig, side, p->x);
	for (int i = 0; i < W * H; i++)
		n += s->face[i] >= 0 && rig_is_globe(p->rig->part[p->rig->faces[s->face[i]][0]]);
	find_margins(&m, p, side);
	double least, middle;
	thicknesses(&least, &middle, &m, p, skin, side);
	printf("%s,%d,%.2f,%.3f,%.3f,%.3f,%d,%.3f,%.3f,%.3f,%.3f,%.2f\n", at, side, n * step * step, bend_of(&m), vertices_off(p, side), faces_off(p, side), crossing(hairs, p, skin, side),
	       under_lower(&m, p, side, 5.7), under_lower(&m, p, side, 2), least, middle, lining_seen(&m, p, side));
	char name[80];
	snprintf(name, sizeof name, "%s_%d", at, side);
	if (folder)
		picture(folder, name, s, p->rig);
	free(s);
}

int main(int argc, char **argv)
{
	struct rig rig = { 0 };
	struct hairs hairs;
	struct err err = { 0 };
	if (argc < 2 || !rig_load(&rig, argv[1], &err)) {
		fprintf(stderr, "lids: %s\n", argc < 2 ? "lids RIG.npz [FOLDER]" : err.msg);
		return 1;
	}
	hairs_grow(&hairs, &rig, 0, &(struct hair_conf){ .lash_mm = 9, .brow_mm = 0, .lashes = 100, .brow_hairs = 0, .margin_mm = 1.1 });
	struct deform *deform = deform_new(&rig);
	struct deform_near near = deform_near_of(&rig);
	int32_t (*faces[2])[3] = { mem_new((size_t)rig.n_faces + 1, sizeof **faces), mem_new((size_t)rig.n_faces + 1, sizeof **faces) };
	struct ray_scene *skin = skin_of(faces[0], &rig, false), *all = skin_of(faces[1], &rig, true);
	float (*x)[3] = mem_new((size_t)rig.n + 1, sizeof *x);
	double *c = mem_new((size_t)rig.n_inputs + 1, sizeof *c);
	static const double across[] = { -20, -10, 0, 10, 20 }, up[] = { 15, 5, 0, -5, -15, -25 }, open[] = { 1, 0.5, 0 };
	const bool expressions = argc == 5 && !strcmp(argv[2], "expressions");
	const int poses = expressions ? 2 * (1 + rig.n_inputs - 10) : COUNT(open) * COUNT(up) * COUNT(across);
	printf("%s,aperture,side,open_mm2,bend_mm,inside_mm,faces_mm,crossing,iris_low,pupil_low,thick_least,thick_mid,lining_mm\n", expressions ? "expression,strength" : "h_deg,v_deg");
	deform_rest(deform, x, 0);
	for (int k = 0; k < poses; k++) {
		const double h = expressions ? strtod(argv[3], 0) : across[k % COUNT(across)], v = expressions ? strtod(argv[4], 0) : up[k / COUNT(across) % COUNT(up)];
		const double o = expressions ? 1 - k % 2 : open[k / (COUNT(across) * COUNT(up))];
		double e[RIG_COMPONENTS], turn[2][3][3];
		char at[64];
		drive_look(c, &rig, h, v, o);
		snprintf(at, sizeof at, "%g,%g,%g", h, v, o);
		if (expressions && k > 1)
			drive_express(c, &rig, k / 2 - 1, 1, o);
		if (expressions)
			snprintf(at, sizeof at, "%d,%d,%g", k / 2 - 1, k > 1, o);
		double lifted[2];
		deform_lifted(lifted, &near, &rig, c);
		rig_components(e, &rig, c);
		rig_globes_turned(turn, &rig, c);
		deform_pose(deform, e, (const double(*)[3][3])turn, x, 0);
		deform_settle(x, &rig, &near, (const double(*)[3][3])turn, lifted);
		ray_scene_move(skin, (const float(*)[3])x);
		ray_scene_move(all, (const float(*)[3])x);
		for (int side = 0; side < 2; side++)
			measure(&(struct pose){ &rig, (const float(*)[3])x, all, (const double(*)[3][3])turn, (const int32_t(*)[3])faces[1] }, skin, &hairs, side, at, argc == 3 ? argv[2] : 0);
	}
	free(c);
	free(x);
	free(faces[0]);
	free(faces[1]);
	ray_scene_free(skin);
	ray_scene_free(all);
	deform_near_free(&near);
	deform_free(deform);
	hairs_free(&hairs);
	rig_free(&rig);
	return fflush(stdout) != 0;
}
