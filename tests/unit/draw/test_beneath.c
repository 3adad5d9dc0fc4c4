/* Light below lids and lashes: a wall over half of an eye's sky, what skin sends, a hair's shadow, skin in its own light against a random walk. */
#include "base/mem.h"
#include "draw/face/impl.h"
#include "math/rng.h"
#include "math/vec.h"
#include "rig/drive.h"
#include "tests/lib/scenes/portrayed.h"
#include "tests/lib/unit.h"

static int setup(void **state)
{
	struct portrayed *m = calloc(1, sizeof *m);
	*state = m;
	return portrayed_make(m, 1) ? 0 : 1;  // the same radiance from everywhere: 1
}

static int teardown(void **state)
{
	portrayed_free(*state);
	free(*state);
	return 0;
}

static struct portrait *portrait_of(const struct portrayed *m, int lights, double lash_mm)
{
	const struct scene *eyes[2] = { &m->eye, &m->eye };
	const struct portrait_conf conf = { .lights = lights, .samples = 2, .eye_samples = 1, .skin_rgb = { 0.6, 0.4, 0.2 },
		                                .hair = { .lash_mm = lash_mm, .lashes = 95, .margin_mm = 1.1 }, .hair_rgb = { 0.022, 0.014, 0.010 } };
	struct portrait *p = portrait_new(&m->rig, eyes, &m->env, &conf);
	double c[12];
	drive_look(c, &m->rig, 0, 0, 1);
	portrait_pose(p, c);
	return p;
}

/* A wall in the place of the skin, upright so many mm beside the middle of the left globe. */
static int32_t wall_faces[2][3] = { { 0, 1, 2 }, { 0, 2, 3 } };
struct walled {
	struct portrait *p;
	struct ray_scene *skin;
	int32_t (*solid)[3];
};

static struct walled walled_make(const struct portrayed *m, float wall)
{
	struct walled w = { portrait_of(m, 64, 0), 0, 0 };
	const double *o = m->rig.globe[0].center;
	const float corner[4][3] = { { (float)o[0] + wall, (float)o[1] - 900, (float)o[2] - 900 }, { (float)o[0] + wall, (float)o[1] + 900, (float)o[2] - 900 },
		                         { (float)o[0] + wall, (float)o[1] + 900, (float)o[2] + 900 }, { (float)o[0] + wall, (float)o[1] - 900, (float)o[2] + 900 } };
	w.skin = w.p->shadow;
	w.solid = w.p->solid;
	w.p->shadow = ray_scene_new(4, corner, 2, (const int32_t(*)[3])wall_faces);
	w.p->solid = wall_faces;
	return w;
}

static void walled_free(struct walled *w)
{
	ray_scene_free(w->p->shadow);
	w->p->shadow = w->skin;
	w->p->solid = w->solid;
	portrait_free(w->p);
}

/* What a camera far before the left eye sees of it, so many mm aside. */
static struct portrait_eye_spot spot_of(const struct portrait *p, double x, double y)
{
	const double *o = p->rig->globe[0].center;
	struct portrait_eye_spot spot;
	assert_true(portrait_eye_meet(&spot, p, 0, (float[]){ (float)(o[0] + x), (float)(o[1] + y), (float)o[2] + 300 }, (float[]){ 0, 0, -1 }));
	return spot;
}

/* A wall upright on the globe beside a place of its white, in light from everywhere: half of the light is left, and as much of what the wall sends; a wall right
 * beside the cornea's apex leaves half of the iris' light in its middle. */
static void a_wall_takes_half(void **state)
{
	const struct portrayed *m = *state;
	for (int bright = 0; bright < 2; bright++)
		for (int iris = 0; iris < 2; iris++) {
			struct walled w = walled_make(m, 6.5f);
			const struct portrait_view view = portrait_front(&m->rig, 0, 40, 0, 0, 64, 64);
			const struct portrait_rays rays = portrait_rays_of(&view);
			struct portrait_beneath *b = portrait_beneath_new(w.p, &rays, 0);
			const float albedo[3] = { 0.6f, 0.4f, 0.2f };
			for (int k = 0; k < 4; k++)
				for (int c = 0; c < 3; c++) {
					w.p->mesh.light[k][c] = bright ? 0.5f : 0;
					w.p->mesh.albedo[k][c] = albedo[c];
				}
			const struct portrait_eye_spot spot = spot_of(w.p, 0, iris ? 0 : 0.75 * m->rig.globe[0].radius);
			float share[3];
			NEAR(spot.white, !iris, 0);
			portrait_beneath_light(share, b, &spot);
			printf("%s: %.3f %.3f %.3f\n", iris ? "iris" : "white", (double)share[0], (double)share[1], (double)share[2]);
			for (int c = 0; c < 3; c++)
				NEAR(share[c], 0.5 + (bright ? 0.25 * (double)albedo[c] : 0), 0.05);
			portrait_beneath_free(b);
			walled_free(&w);
		}
}

/* In the open all is left, of the iris behind its cornea, too. */
static void nothing_before_it_leaves_all(void **state)
{
	const struct portrayed *m = *state;
	struct walled w = walled_make(m, 500);
	const struct portrait_view view = portrait_front(&m->rig, 0, 40, 0, 0, 64, 64);
	const struct portrait_rays rays = portrait_rays_of(&view);
	struct portrait_beneath *b = portrait_beneath_new(w.p, &rays, 0);
	int irises = 0, whites = 0;
	for (int k = 0; k < 100; k++) {
		const struct portrait_eye_spot spot = spot_of(w.p, (k % 10 - 4.5) * 1.7, (k / 10 - 4.5) * 1.7);
		float share[3], rgb[3], dir[3] = { 0, 0, -1 };
		portrait_beneath_light(share, b, &spot);
		irises += spot.white == 0;
		whites += spot.white == 1;
		for (int c = 0; c < 3; c++)
			NEAR(share[c], 1, 1e-4);
		NEAR(portrait_beneath_mirrored(rgb, b, &spot, dir), 1, 0);
	}
	assert_true(irises > 10 && whites > 40);
	portrait_beneath_free(b);
	walled_free(&w);
}

/* The shadow of all lashes in light from before: the integral of its optical depth is the area of all hairs as the light sees them; a place before them has none. */
static void a_shadow_is_as_large_as_the_hairs(void **state)
{
	const struct portrayed *m = *state;
	struct portrait *p = portrait_of(m, 8, 9);
	const struct envmap_light light[2] = { { { 0, 0, 1 }, { 1, 1, 1 } }, { { 0.6f, 0, 0.8f }, { 1, 1, 1 } } };
	for (int brows = 0; brows < 2; brows++) {
		struct portrait_fringe *f = portrait_fringe_new(p, 0, brows, 2, light);
		const double *o = m->rig.globe[0].center, step = 0.05;
		double area = 0, sum = 0, before = 0;
		for (int i = 0; i < p->hairs.n; i++) {
			const struct hair *h = &p->hairs.hair[i];
			float x[HAIR_LASH_POINTS][3];
			if (h->side != 0 || h->kind == HAIR_BROW)
				continue;
			hair_place(x, &p->hairs, h, &m->rig, (const float(*)[3])p->mesh.x);
			for (int k = 0; k + 1 < h->n; k++)
				area += (double)(hair_half(h, k) + hair_half(h, k + 1)) * hypot((double)(x[k + 1][0] - x[k][0]), (double)(x[k + 1][1] - x[k][1]));
		}
		for (double y = -30; y < 30; y += step)
			for (double x = -30; x < 30; x += step) {
				sum -= step * step * log((double)portrait_fringe_through(f, 0, (float[]){ (float)(o[0] + x), (float)(o[1] + y), (float)o[2] - 20 }));
				before -= log((double)portrait_fringe_through(f, 0, (float[]){ (float)(o[0] + x), (float)(o[1] + y), (float)o[2] + 60 }));
			}
		printf("hairs of %.2f mm2 have a shadow of %.2f\n", area, sum);
		assert_true(area > 3);
		if (!brows)
			NEAR(sum, area, 0.03 * area);
		NEAR(before, 0, 0);
		portrait_fringe_free(f);
	}
	portrait_free(p);
}

/* A random walk over the skin: the light of a place is the mean of what its paths have left where they escape. */
static double walked(const struct portrait *p, int i, int c, int paths, struct rng *rng)
{
	double sum = 0;
	for (int k = 0; k < paths; k++) {
		float at[3], n[3];
		double left = 1;
		for (int d = 0; d < 3; d++) {
			n[d] = p->mesh.normal[i][d];
			at[d] = p->mesh.x[i][d] + 0.15f * n[d];
		}
		for (int bounce = 0; bounce < 40; bounce++) {
			const double r2 = rng_uniform(rng), turn = 2 * M_PI * rng_uniform(rng), up = sqrt(1 - r2);
			double u[3], v[3], nd[3] = { (double)n[0], (double)n[1], (double)n[2] };
			float dir[3];
			vec_cross(u, nd, fabs(nd[0]) < 0.6 ? (double[]){ 1, 0, 0 } : (double[]){ 0, 1, 0 });
			vec_unit(u, u);
			vec_cross(v, nd, u);
			for (int d = 0; d < 3; d++)
				dir[d] = (float)(sqrt(r2) * cos(turn) * u[d] + sqrt(r2) * sin(turn) * v[d] + up * nd[d]);
			const struct ray_hit hit = ray_first(p->shadow, at, dir, 0.25f, 120);
			if (hit.face < 0) {
				sum += left;
				break;
			}
			const int32_t *f = p->solid[hit.face];
			const float w[3] = { 1 - hit.u - hit.v, hit.u, hit.v };
			double albedo = 0, len = 0, off[3] = { 0 };
			for (int j = 0; j < 3; j++) {
				albedo += (double)(w[j] * p->mesh.albedo[f[j]][c]);
				for (int d = 0; d < 3; d++)
					off[d] += (double)(w[j] * p->mesh.normal[f[j]][d]);
			}
			len = vec_norm(off);
			const bool inside = off[0] * (double)dir[0] + off[1] * (double)dir[1] + off[2] * (double)dir[2] > 0;
			left *= albedo;
			for (int d = 0; d < 3; d++) {
				n[d] = (float)(off[d] / len) * (inside ? -1 : 1);
				at[d] += hit.t * dir[d] + 0.15f * n[d];
			}
		}
	}
	return sum / paths;
}

/* In light from everywhere, with what skin sends to skin, folds and sockets are as bright as paths of light make them. */
static void skin_lights_skin(void **state)
{
	const struct portrayed *m = *state;
	struct portrait *p = portrait_of(m, 64, 0);
	const struct portrait_view view = portrait_front(&m->rig, -1, 110, 0, 0, 64, 64);
	struct rng rng = { 5 };
	double off = 0, alone = 0, dark = 0;
	int n = 0;
	portrait_light(p, &view, true);
	for (int i = 0; i < m->rig.n; i += 3) {
		if (p->near_start[i + 1] == p->near_start[i] || m->rig.part[i] != RIG_SKIN || p->mesh.open[i] > 0.9f || p->mesh.open[i] < 0.15f)
			continue;
		const double want = walked(p, i, 0, 1500, &rng);
		off += pow((double)p->lit[i][0] - want, 2);
		alone += pow((double)p->direct[i][0] - want, 2);
		dark += want;
		n++;
	}
	off = sqrt(off / n);
	alone = sqrt(alone / n);
	printf("%d places, %.2f bright: off by %.3f rms, without what skin sends by %.3f\n", n, dark / n, off, alone);
	assert_true(n > 50);
	assert_true(alone > 0.05);
	assert_true(off < 0.4 * alone);
	portrait_free(p);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_wall_takes_half),
		cmocka_unit_test(nothing_before_it_leaves_all),
		cmocka_unit_test(a_shadow_is_as_large_as_the_hairs),
		cmocka_unit_test(skin_lights_skin),
	};
	return cmocka_run_group_tests(tests, setup, teardown);
}
