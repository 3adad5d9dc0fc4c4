/* Vessels of the white: a tree that hangs together, and those of a photograph. */
#include "base/mem.h"
#include "draw/eye/sclera.h"
#include "draw/eye/vessels.h"
#include "draw/photo/vessels.h"
#include "math/rng.h"
#include "math/vec.h"
#include "tests/lib/scenes/plain_scene.h"
#include "tests/lib/unit.h"

enum { MAP = 768 };
static const double radius = 11.8, limbus = 0.519;
static const struct vessel_habit habit = { .points = 500, .roots = 12, .limbus = 0.519, .radius = 11.8, .step = 0.25, .reach = 4, .near = 0.6, .width = 0.02, .sway = 0.4, .wave = 2.5 };

static double polar_of(const double at[3])
{
	return acos(fmin(fmax(-at[2], -1), 1));
}

/* Every vessel leads to a root, step by step; widths are Murray's; none comes onto the cornea, and most of the white has one nearby. */
static void one_tree(void **state)
{
	(void)state;
	struct vessels v = vessels_grow(&habit, 3), again = vessels_grow(&habit, 3);
	assert_int_equal(v.n, again.n);
	assert_memory_equal(v.node, again.node, (size_t)v.n * sizeof *v.node);
	double *cubes = mem_new((size_t)v.n, sizeof *cubes);
	int roots = 0;
	for (int k = v.n - 1; k >= 0; k--) {
		const struct vessel_node *p = &v.node[k];
		assert_true(p->parent < k && polar_of(p->at) > limbus);
		assert_float_equal(vec_norm(p->at), 1, 1e-9);
		if (cubes[k] > 0)
			assert_float_equal(pow(p->width, 3), fmax(cubes[k], pow(habit.width, 3)), 1e-9);
		roots += p->parent < 0;
		if (p->parent < 0)
			continue;
		cubes[p->parent] += pow(p->width, 3);
		double d[3];
		for (int i = 0; i < 3; i++)
			d[i] = radius * (p->at[i] - v.node[p->parent].at[i]);
		assert_true(vec_norm(d) < 2 * habit.step);
	}
	assert_int_equal(roots, habit.roots);
	struct rng rng = { 5 };
	int far = 0;
	for (int i = 0; i < 200; i++) {
		double polar = rng_range(&rng, limbus + 0.1, 1.4), turn = 2 * M_PI * rng_uniform(&rng), at[3] = { sin(polar) * cos(turn), sin(polar) * sin(turn), -cos(polar) }, nearest = INFINITY;
		for (int k = 0; k < v.n; k++) {
			double d[3] = { at[0] - v.node[k].at[0], at[1] - v.node[k].at[1], at[2] - v.node[k].at[2] };
			nearest = fmin(nearest, radius * vec_norm(d));
		}
		far += nearest > 3;
	}
	print_message("vessels: %d twigs, %d of 200 places farther than 3 mm from any\n", v.n, far);
	assert_true(far < 20);
	free(cubes);
	vessels_free(&v);
	vessels_free(&again);
}

/* A map with a vessel that ends where a photograph ends: one grows there, and none where the photograph shows white. */
static void grown_on(void **state)
{
	(void)state;
	struct image seen = image_new(MAP, MAP, 2);
	struct vessel_habit on = habit;
	on.seen = &seen;
	on.seen_reach = SCENE_SCLERA_REACH;
	double end = INFINITY;
	for (int y = 0; y < MAP; y++)
		for (int x = 0; x < MAP; x++) {
			double u = (x + 0.5) / MAP - 0.5, v = (y + 0.5) / MAP - 0.5, polar = 2 * SCENE_SCLERA_REACH * hypot(u, v);
			float *p = image_at(&seen, x, y), w = (float)fmin(fmax((1 - polar) / 0.1, 0), 1);  // white to an angle of 0.9 to 1
			p[1] = w;
			p[0] = u > 0 && fabs(v) < 1.5 / MAP && w > 0.3f ? 0.8f : 0;
		}
	struct vessels v = vessels_grow(&on, 4);
	struct image cover = image_new(MAP, MAP, 1);
	vessels_draw(&cover, &v, SCENE_SCLERA_REACH, radius);
	int within = 0;
	for (int k = 0; k < v.n; k++) {
		double d[3] = { v.node[k].at[0] - sin(0.96), v.node[k].at[1], v.node[k].at[2] + cos(0.96) };
		end = fmin(end, radius * vec_norm(d));
		within += polar_of(v.node[k].at) < 0.85;
		double u = 0.5 * polar_of(v.node[k].at) / SCENE_SCLERA_REACH / fmax(hypot(v.node[k].at[0], v.node[k].at[1]), 1e-9);
		if (v.node[k].parent >= 0)
			assert_true(*image_at(&cover, (int)(MAP * (0.5 + u * v.node[k].at[0])), (int)(MAP * (0.5 + u * v.node[k].at[1]))) > 0);
	}
	print_message("grown on: %.2f mm from where the photograph's ends; %d of %d twigs within what it shows\n", end, within, v.n);
	assert_true(end < 1);
	assert_true(within < v.n / 50);
	vessels_free(&v);
	image_free(&seen);
	image_free(&cover);
}

/* A painted eye, 100 mm before the lens: vessels along arcs of the sphere, one lash as dark as they in front of the white, skin above and below. */
static const double arc[][4] = { { 0.62, 0.1, 0.95, 0.25 }, { 0.65, 2.9, 0.98, 3.05 }, { 0.60, -0.35, 0.90, -0.2 }, { 0.7, 3.3, 0.95, 3.5 } }, arc_width[] = { 0.10, 0.07, 0.05, 0.05 };  // polar, turn: from, to; mm

static double arc_distance(const double n[3], const double a[4])
{
	double nearest = INFINITY;
	for (int k = 0; k <= 40; k++) {
		double polar = a[0] + (a[2] - a[0]) * k / 40, turn = a[1] + (a[3] - a[1]) * k / 40;
		double d[3] = { sin(polar) * cos(turn) - n[0], sin(polar) * sin(turn) - n[1], -cos(polar) - n[2] };
		nearest = fmin(nearest, radius * vec_norm(d));
	}
	return nearest;
}

static void paint(struct shot *shot, const struct eye *eye)
{
	enum { W = 1000, H = 640, TOLD = 8 };  // TOLD: pixels of the photograph in one of the evidence's, which knows no lash
	*shot = (struct shot){ .fit = { .ok = true, .width = W, .height = H }, .window = { 0, 0, W, H }, .scale = 1 };
	struct fit *f = &shot->fit;
	f->camera = (struct camera){ .source = CAMERA_CONF, .focal_px = 3570, .center_px = { W / 2.0, H / 2.0 } };
	for (int i = 0; i < 4; i++)
		f->cam_from_eye[i][i] = 1;
	f->cam_from_eye[2][3] = 100;
	shot->image = image_new(W, H, 3);
	shot->told = (struct evidence){ .width = W / TOLD, .height = H / TOLD, .scale = TOLD, .plane = { mem_new(EVIDENCE_CLASSES * (W / TOLD) * (H / TOLD), sizeof(float)) } };
	for (int c = 1; c < EVIDENCE_CLASSES; c++)
		shot->told.plane[c] = shot->told.plane[0] + c * (W / TOLD) * (H / TOLD);
	const double z = eye_limbus_depth(eye) + sqrt(radius * radius - eye->limbus_radius * eye->limbus_radius);
	struct rng rng = { 8 };
	for (int y = 0; y < H; y++)
		for (int x = 0; x < W; x++) {
			double o[3], d[3], q[3], n[3], white[3] = { 0.62, 0.57, 0.52 };
			fit_ray(o, d, f, (double[2]){ x + 0.5, y + 0.5 });
			for (int i = 0; i < 3; i++)
				q[i] = o[i] - (i == 2 ? z : 0);
			double b = vec_dot(q, d), disc = b * b - vec_dot(q, q) + radius * radius, flat;
			for (int i = 0; i < 3; i++)
				n[i] = (q[i] + (-b - sqrt(fmax(disc, 0))) * d[i]) / radius;
			flat = hypot(n[0], n[1]) * radius;
			double light = 0.4 + 0.6 * fmax(-n[2], 0);
			for (int k = 0; k < COUNT(arc) && disc > 0 && flat > eye->limbus_radius; k++) {
				double off = arc_distance(n, arc[k]), share = fmin(fmax((0.5 * arc_width[k] - off) / 0.02 + 0.5, 0), 1);
				for (int c = 0; c < 3; c++)
					white[c] *= 1 - share * (c ? 0.55 : 0.06);
			}
			if (fabs(x - 180 - 0.2 * y) < 1.8)
				light *= 0.12;  // a lash
			if (!(disc > 0) || fabs(n[1]) > 0.5)
				white[0] = 0.55, white[1] = 0.33, white[2] = 0.26;
			else if (flat < eye->limbus_radius)
				white[0] = white[1] = white[2] = 0.1;
			else
				shot->told.plane[EVIDENCE_SCLERA][y / TOLD * (W / TOLD) + x / TOLD] += 1.0f / (TOLD * TOLD);
			if (disc > 0 && n[0] > 0.72 && fabs(n[1]) <= 0.5)
				white[1] *= 0.6, white[2] *= 0.6;  // a caruncle, white to the evidence
			for (int c = 0; c < 3; c++)
				image_at(&shot->image, x, y)[c] = (float)(white[c] * light * (1 + 0.015 * rng_normal(&rng)));
		}
}

static void of_photo(void **state)
{
	(void)state;
	struct eye eye = plain_eye;
	struct shot *shot = mem_new(1, sizeof *shot);
	struct image seen;
	paint(shot, &eye);
	assert_true(vessels_of_photo(&seen, shot, &eye, radius, MAP));
	long on = 0, found = 0, off = 0, wrong = 0;
	double cover = 0;
	for (int y = 0; y < MAP; y++)
		for (int x = 0; x < MAP; x++) {
			const float *p = image_at(&seen, x, y);
			double u = (x + 0.5) / MAP - 0.5, v = (y + 0.5) / MAP - 0.5, polar = 2 * SCENE_SCLERA_REACH * hypot(u, v), turn = atan2(v, u), nearest = INFINITY;
			double n[3] = { sin(polar) * cos(turn), sin(polar) * sin(turn), -cos(polar) };
			if (p[1] < 0.95f)
				continue;
			for (int k = 0; k < COUNT(arc); k++)
				nearest = fmin(nearest, arc_distance(n, arc[k]) - 0.5 * arc_width[k]);
			on += nearest < -0.01;
			found += nearest < -0.01 && p[0] > 0.1f;
			cover += nearest < -0.01 ? (double)p[0] : 0;
			off += nearest > 0.15;
			wrong += nearest > 0.15 && p[0] > 0.05f;
		}
	print_message("a photograph's vessels: %ld of %ld texels found, mean cover %.2f; %ld of %ld others taken for one\n", found, on, cover / (double)on, wrong, off);
	assert_true(on > 40 && found > 0.9 * (double)on && cover > 0.4 * (double)on);
	assert_true(off > 20000 && wrong < 0.005 * (double)off);
	// A white as brown as skin shows the same vessels: what is white is not told by colour.
	const long px = (long)shot->image.width * shot->image.height;
	for (long i = 0; i < 3 * px; i++)
		shot->image.px[i] *= (float[]){ 1, 0.6f, 0.47f }[i % 3];
	struct image brown;
	assert_true(vessels_of_photo(&brown, shot, &eye, radius, MAP));
	double apart = 0;
	for (long i = 0; i < 2L * MAP * MAP; i++)
		apart = fmax(apart, fabs((double)(seen.px[i] - brown.px[i])));
	assert_true(apart < 0.02);
	image_free(&brown);
	image_free(&seen);
	// Skin alone, or an iris without white beside it, shows none, whatever its colour.
	for (int i = 0; i < shot->told.width * shot->told.height; i++)
		shot->told.plane[EVIDENCE_SCLERA][i] = 0;
	assert_false(vessels_of_photo(&seen, shot, &eye, radius, MAP));
	image_free(&shot->image);
	evidence_free(&shot->told);
	free(shot);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(one_tree),
		cmocka_unit_test(grown_on),
		cmocka_unit_test(of_photo),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
