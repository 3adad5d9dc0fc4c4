/* An exported eye: its meshes and maps against closed forms, its files against Khronos's validator. */
#include "draw/eye/look.h"
#include "draw/eye/sclera.h"
#include "export/eye_glb.h"
#include "export/lod.h"
#include "export/loss.h"
#include "export/outside.h"
#include "image/picture.h"
#include "tests/lib/gltf.h"
#include "tests/lib/scenes/plain_scene.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

static const struct export_mesh_conf mesh = { .iris_rings = 32, .around = 48 };
static const double slope = 0.05;  // of the relief, along x

/* An eye whose relief is a plane that rises towards +x. */
static void tilted(struct scene *s, const struct eye *eye)
{
	struct scene_conf conf = conf_of(4);
	conf.veins_px = 512;  // the cornea's maps have half of that
	scene_of(s, eye, &conf, even, 0, 1.5);
	struct scene_level *l = &s->level[0];
	for (int i = 0; i < l->n * l->n; i++)
		l->relief[2 * i] = (float)(slope * ((i % l->n + 0.5) / l->per_mm - s->extent));
}

static void parts_free(struct export_part parts[EXPORT_PARTS])
{
	for (int i = 0; i < EXPORT_PARTS; i++)
		export_part_free(&parts[i]);
}

/* Inside the limbus every vertex fulfils the conic; behind the sulcus all lie on the sphere; both meshes share the seam. */
static void cornea_and_sclera(void **state)
{
	(void)state;
	struct scene s;
	struct export_part parts[EXPORT_PARTS], *c = &parts[EXPORT_CORNEA], *w = &parts[EXPORT_SCLERA];
	tilted(&s, &plain_eye);
	export_eye_meshes(parts, &s, &mesh);
	int on_conic = 0, on_sphere = 0;
	for (int i = 0; i < c->n; i++) {
		double r2 = (double)c->x[i][0] * c->x[i][0] + (double)c->x[i][1] * c->x[i][1], z = s.sclera_z - c->x[i][2];
		if (sqrt(r2) > 0.99 * s.limbus[0])
			continue;
		NEAR(r2 - 2 * plain_eye.cornea_radius * z + plain_eye.cornea_asphericity * z * z, 0, 5e-5);  // floats of 10 mm
		on_conic++;
	}
	for (int i = 0; i < w->n; i++) {
		double r2 = (double)w->x[i][0] * w->x[i][0] + (double)w->x[i][1] * w->x[i][1], z = w->x[i][2];
		if (z > 0 && sqrt(r2) < 1.3 * s.limbus[0])
			continue;
		NEAR(sqrt(r2 + z * z), s.conf.sclera_radius, 1e-5);
		on_sphere++;
	}
	assert_true(on_conic > c->n / 2 && on_sphere > w->n / 2);
	assert_memory_equal(c->x[c->n - mesh.around], w->x[0], (size_t)mesh.around * sizeof *c->x);
	NEAR(c->x[0][2], s.sclera_z, 1e-5);  // the apex
	parts_free(parts);
	scene_free(&s);
}

/* Each triangle's own normal leans to the side of its vertices'. */
static void faces_look_outwards(void **state)
{
	(void)state;
	struct scene s;
	struct export_part parts[EXPORT_PARTS];
	tilted(&s, &plain_eye);
	export_eye_meshes(parts, &s, &mesh);
	for (int k = 0; k < EXPORT_PARTS; k++) {
		const struct export_part *p = &parts[k];
		// The lip's triangles turn under: they look down.
		for (int t = k == EXPORT_IRIS ? 4 * mesh.around : 0; t < p->n_corners / 3; t++) {
			const float *a = p->x[p->corner[3 * t]], *b = p->x[p->corner[3 * t + 1]], *c = p->x[p->corner[3 * t + 2]], *n = p->normal[p->corner[3 * t]];
			double u[3], v[3];
			for (int i = 0; i < 3; i++) {
				u[i] = b[i] - a[i];
				v[i] = c[i] - a[i];
			}
			assert_true((u[1] * v[2] - u[2] * v[1]) * n[0] + (u[2] * v[0] - u[0] * v[2]) * n[1] + (u[0] * v[1] - u[1] * v[0]) * n[2] > 0);
		}
	}
	parts_free(parts);
	scene_free(&s);
}

/* The margin is a circle of the stated diameter at any weights; the root stays; the relief is the plane it was made of. */
static void pupil_at_any_weight(void **state)
{
	(void)state;
	struct scene s;
	struct export_part parts[EXPORT_PARTS], *p = &parts[EXPORT_IRIS];
	tilted(&s, &plain_eye);
	export_eye_meshes(parts, &s, &mesh);
	int around = 2 * mesh.around;
	static const double weights[][2] = { { 0, 0 }, { 1, 0 }, { 0, 1 }, { 0.5, 0 }, { 0, 0.25 } };
	for (size_t k = 0; k < sizeof weights / sizeof *weights; k++) {
		double want = 2 * s.pupil[2];
		for (int m = 0; m < EXPORT_TARGETS; m++)
			want += weights[k][m] * (export_pupils[m] - 2 * s.pupil[2]);
		for (int i = 0; i < around; i++) {
			double at[2][2];
			for (int ring = 0; ring < 2; ring++)
				for (int c = 0; c < 2; c++) {
					int v = (ring ? p->n - around : around) + i;
					at[ring][c] = p->x[v][c] + weights[k][0] * p->target[0][v][c] + weights[k][1] * p->target[1][v][c];
				}
			NEAR(2 * hypot(at[0][0] - s.pupil[0], at[0][1] + s.pupil[1]), want, 1e-5);
			NEAR(hypot(at[1][0], at[1][1]), export_iris_root(&s), 1e-5);
		}
	}
	for (int i = around; i < p->n; i++)
		NEAR(p->x[i][2], s.sclera_z - plain_eye.iris_depth + slope * p->x[i][0], 2e-4);  // heights are bilinear between floats
	parts_free(parts);
	scene_free(&s);
}

/* lamp: radiance of a lamp that stands aside in an even room. */
static void maps_under(struct image maps[EXPORT_MAPS], const struct scene *s, double room, double lamp)
{
	struct err err = { 0 };
	const struct envmap_box box = { { -0.8, 0, -0.6 }, { 0.15, 0.15 }, { lamp, lamp, lamp }, 0 };
	struct envmap env = envmap_room(32, (double[3]){ room, room, room }, (double[3]){ room, room, room }, 1, lamp > 0, &box);
	if (!export_eye_maps(maps, s, 0, &env, 256, &err))
		fail_msg("%s", err.msg);
	envmap_free(&env);
}

static void maps_of(struct image maps[EXPORT_MAPS], const struct scene *s)
{
	maps_under(maps, s, 1, 0);
}

static void maps_free(struct image maps[EXPORT_MAPS])
{
	for (int i = 0; i < EXPORT_MAPS; i++)
		image_free(&maps[i]);
}

/* The pattern of the albedo is that of even light; light from one side changes it by one factor a channel, and its strength by nothing. */
static void albedo_of_other_light(void **state)
{
	(void)state;
	struct scene s;
	struct image even[EXPORT_MAPS], strong[EXPORT_MAPS], aside[EXPORT_MAPS];
	double least = INFINITY, most = 0;
	tilted(&s, &plain_eye);
	maps_under(even, &s, 1, 0);
	maps_under(strong, &s, 3, 0);
	maps_under(aside, &s, 0.1, 30);
	for (int y = 8; y < 248; y += 8)
		for (int x = 8; x < 248; x += 8) {
			const float *a = image_at(&even[EXPORT_IRIS_ALBEDO], x, y), *b = image_at(&strong[EXPORT_IRIS_ALBEDO], x, y), *c = image_at(&aside[EXPORT_IRIS_ALBEDO], x, y);
			assert_true(fabs(a[1] - b[1]) < 1e-5 + 0.005 * a[1]);  // an even room is cut into regions in many ways
			if (a[1] > 0.01f && a[1] < 0.9f && c[1] < 0.9f) {
				least = fmin(least, c[1] / a[1]);
				most = fmax(most, c[1] / a[1]);
			}
		}
	assert_true(isfinite(least) && most - least < 0.01 * most);
	maps_free(even);
	maps_free(strong);
	maps_free(aside);
	scene_free(&s);
}

/* A slope's normal; on the axis the way to the iris is the chamber's depth, off it what Snell's law gives. */
static void maps_of_a_slope(void **state)
{
	(void)state;
	struct scene s;
	struct image maps[EXPORT_MAPS];
	tilted(&s, &plain_eye);
	maps_of(maps, &s);
	for (int x = 20; x < 236; x += 16) {
		const float *n = image_at(&maps[EXPORT_IRIS_NORMAL], x, 100);
		NEAR(n[0], -slope / sqrt(1 + slope * slope), 1e-4);
		NEAR(n[1], 0, 1e-4);
		NEAR(*image_at(&maps[EXPORT_IRIS_HEIGHT], x, 100), slope * ((x + 0.5) / 128 - 1) * s.extent, 1e-3);
	}
	const struct image *depth = &maps[EXPORT_CORNEA_DEPTH];
	double mm = 2 * export_cornea_extent(&s) / depth->width;
	for (int x = depth->width / 2; (x + 0.5 - depth->width / 2) * mm < 4.5; x += 8) {
		double r = (x + 0.5 - depth->width / 2) * mm, R = plain_eye.cornea_radius, q = plain_eye.cornea_asphericity, h = hypot(r, 0.5 * mm);
		double z = h * h / (R + sqrt(R * R - q * h * h)), lean = atan2(h, R - q * z), bent = lean - asin(sin(lean) / plain_eye.index);
		NEAR(*image_at(depth, x, depth->height / 2), (plain_eye.iris_depth - z) / cos(bent), 1e-5);
	}
	maps_free(maps);
	scene_free(&s);
}

/* Each texel of a map of n px against its own formula of the texel's place, -1 .. 1. */
static void each(const struct image *map, double (*want)(const struct scene *s, double u, double v), const struct scene *s, double within)
{
	for (int y = 3; y < map->height; y += 7)
		for (int x = 3; x < map->width; x += 7) {
			double u = (x + 0.5) / map->width * 2 - 1, v = (y + 0.5) / map->height * 2 - 1, is = want(s, u, v);
			if (isfinite(is))
				NEAR(*image_at(map, x, y), is, within);
		}
}

/* Stroma that grows thicker downwards; vessels that take more to the right; a freckle that fades outwards. */
static double thick(const struct scene *s, double u, double v)
{
	(void)u;
	(void)s;
	return fabs(v) < 0.95 ? 0.6 + 0.3 * v : NAN;   // the map is larger than the scene's: its last half texel has no neighbour
}

static double taken(const struct scene *s, double u, double v)
{
	(void)s;
	(void)v;
	return fabs(u) < 0.95 ? 0.4 + 0.35 * u : NAN;
}

static double faded(const struct scene *s, double u, double v)
{
	(void)s;
	return hypot(u, v) < 0.9 ? 0.9 - 0.8 * (u * u + v * v) : NAN;
}

/* The film is as rough as half-vectors spread by 3 degrees, from the limbus on, over the step 1 to 1.35 of its radius; smooth before it. */
static double rough_at(double rho)
{
	const double t = fmin(fmax((rho - LOOK_FILM_FROM) / (LOOK_FILM_TO - LOOK_FILM_FROM), 0), 1);
	return sqrt(sqrt(2) * tan(3 * M_PI / 180) * LOOK_FILM_ROUGH * t * t * (3 - 2 * t));
}

static double rough_cornea(const struct scene *s, double u, double v)
{
	return rough_at(export_cornea_extent(s) * hypot(u / s->limbus[0], v / s->limbus[1]));
}

static double rough_sclera(const struct scene *s, double u, double v)
{
	const double angle = hypot(u, v) * SCENE_SCLERA_REACH;
	if (angle < 0.6)  // the cornea's own surface stands before the sphere there
		return NAN;
	return rough_at(angle < M_PI / 2 ? s->conf.sclera_radius * sin(angle) * hypot(u / s->limbus[0], v / s->limbus[1]) / hypot(u, v) : 2);
}

static void maps_of_what_is_known(void **state)
{
	(void)state;
	struct scene s;
	struct image maps[EXPORT_MAPS], freckles = image_new(300, 300, 1);
	struct envmap env = envmap_room(32, grey, grey, 1, 0, 0);
	struct err err = { 0 };
	tilted(&s, &plain_eye);
	struct scene_level *l = &s.level[0];
	for (int i = 0; i < l->n * l->n; i++)
		l->relief[2 * i + 1] = (float)(0.6 + 0.3 * ((i / l->n + 0.5) / l->n * 2 - 1));
	for (int i = 0; i < s.veins.width * s.veins.height; i++)
		s.veins.px[4 * i + 3] = (float)(0.4 + 0.35 * ((i % s.veins.width + 0.5) / s.veins.width * 2 - 1));
	for (int i = 0; i < 300 * 300; i++) {
		const double u = (i % 300 + 0.5) / 150 - 1, v = (i / 300 + 0.5) / 150 - 1;
		freckles.px[i] = (float)fmax(0.9 - 0.8 * (u * u + v * v), 0);
	}
	assert_true(export_eye_maps(maps, &s, &freckles, &env, 256, &err));
	each(&maps[EXPORT_IRIS_THICKNESS], thick, &s, 2e-3);   // resampled from 192 texels
	each(&maps[EXPORT_SCLERA_VESSELS], taken, &s, 2e-3);
	each(&maps[EXPORT_IRIS_FRECKLES], faded, &s, 2e-3);
	each(&maps[EXPORT_CORNEA_ROUGHNESS], rough_cornea, &s, 1e-5);
	each(&maps[EXPORT_SCLERA_ROUGHNESS], rough_sclera, &s, 1e-5);
	maps_free(maps);
	assert_true(export_eye_maps(maps, &s, 0, &env, 256, &err));
	for (int i = 0; i < maps[EXPORT_IRIS_FRECKLES].width * maps[EXPORT_IRIS_FRECKLES].height; i++)
		assert_true(maps[EXPORT_IRIS_FRECKLES].px[i] == 0);   // an iris without freckles has none
	maps_free(maps);
	image_free(&freckles);
	envmap_free(&env);
	scene_free(&s);
}

static struct export_loss loss_at(double deg, double index)
{
	struct eye eye = plain_eye;
	struct scene s;
	struct image maps[EXPORT_MAPS];
	eye.index = index;
	tilted(&s, &eye);
	maps_of(maps, &s);
	struct envmap env = envmap_room(32, grey, grey, 1, 0, 0);
	struct scene_lighting light = scene_lighting(&env, &env, 4);
	struct scene_view view = scene_view_turned(&s, deg * M_PI / 180, 0, 27, 128);
	struct image drawn = scene_render(&s, &view, &light, 0);
	struct export_loss loss = export_loss_of(&s, maps, &view, &env, &drawn, 1);
	image_free(&drawn);
	envmap_free(&env);
	maps_free(maps);
	scene_free(&s);
	return loss;
}

/* Nothing is lost where nothing bends, from any side; along the axis of a bending cornea next to nothing; from aside something is. */
static void what_a_rasteriser_loses(void **state)
{
	(void)state;
	NEAR(loss_at(0, 1).mm_most, 0, 1e-4);
	NEAR(loss_at(60, 1).mm_most, 0, 1e-4);
	NEAR(loss_at(0, 1.336).mm_most, 0, 2e-3);  // the lens is half a metre away, not at infinity
	struct export_loss aside = loss_at(60, 1.336);
	assert_true(aside.mm_mean > 0.1 && aside.mm_mean < aside.mm_most && aside.mm_most < 2);
}

/* Fewer triangles, the same border, no vertex that was not there. */
static void fewer_triangles(void **state)
{
	(void)state;
	struct scene s;
	struct export_part parts[EXPORT_PARTS];
	double error;
	tilted(&s, &plain_eye);
	export_eye_meshes(parts, &s, &mesh);
	const struct export_part *whole = &parts[EXPORT_IRIS];
	struct export_part less = export_lod(whole, whole->n_corners / 12, &error);
	assert_true(less.n_corners <= whole->n_corners / 4 + 300 && less.n < whole->n);
	assert_true(error >= 0 && error < 0.01);  // a plane stays a plane
	int root = 0;
	for (int i = 0; i < less.n; i++)
		root += fabs(hypot(less.x[i][0], less.x[i][1]) - export_iris_root(&s)) < 1e-5;
	assert_int_equal(root, 2 * mesh.around);
	export_part_free(&less);
	parts_free(parts);
	scene_free(&s);
}

static void khronos_validator_finds_nothing(void **state)
{
	(void)state;
	if (!gltf_validator_there()) {
		print_message("skipped: no node, or npm could not install gltf-validator\n");
		skip();
	}
	struct scene s;
	struct export_part parts[EXPORT_PARTS];
	struct export_png one, png[EXPORT_PICTURES];
	struct err err = { 0 };
	long bytes;
	tilted(&s, &plain_eye);
	export_eye_meshes(parts, &s, &mesh);
	assert_true(picture_png_encode(&one.data, &one.size, (uint8_t[12]){ 0 }, 2, 2, 3, &err));
	for (int i = 0; i < EXPORT_PICTURES; i++)
		png[i] = one;
	struct export_eye eye = { parts, png, 1.336, 4, "eye", "{\"stage\": \"render\"}", 3, 0, { 0 } };
	const char *path = scratch_path("eye.glb");
	assert_true(export_eye_glb(path, &eye, &bytes, &err));
	assert_true(gltf_is_valid(path));
	free(one.data);
	parts_free(parts);
	scene_free(&s);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(cornea_and_sclera),  cmocka_unit_test(faces_look_outwards),     cmocka_unit_test(pupil_at_any_weight),
		cmocka_unit_test(maps_of_a_slope), cmocka_unit_test(maps_of_what_is_known), cmocka_unit_test(albedo_of_other_light),    cmocka_unit_test(what_a_rasteriser_loses), cmocka_unit_test(fewer_triangles),
		SCRATCH_TEST(khronos_validator_finds_nothing),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
