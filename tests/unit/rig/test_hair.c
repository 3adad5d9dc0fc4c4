/* Lashes and brows of a made face: where they are rooted, that none goes through the skin, that they move with it, and their triangles. */
#include "math/vec.h"
#include "mesh/ray.h"
#include "rig/drive.h"
#include "rig/deform/deform.h"
#include "rig/glb/strands.h"
#include "rig/hair/hair.h"
#include "tests/lib/scenes/face.h"
#include "tests/lib/unit.h"

struct made {
	struct face face;
	struct rig rig;
	struct hairs hairs;
};

static const struct hair_conf conf = { .lash_mm = 9, .brow_mm = 8, .lashes = 100, .brow_hairs = 200, .margin_mm = 1.1 };

static int setup(void **state)
{
	struct made *m = calloc(1, sizeof *m);
	struct err err = { 0 };
	struct rig_conf rig = face_conf();
	face_make(&m->face, false);
	rig.map_step = 4;
	const bool ok = face_rig(&m->rig, 0, &m->face, &rig, &err);
	hairs_grow(&m->hairs, &m->rig, 0, &conf);
	*state = m;
	return ok ? 0 : 1;
}

static int teardown(void **state)
{
	struct made *m = *state;
	hairs_free(&m->hairs);
	rig_free(&m->rig);
	face_free(&m->face);
	free(m);
	return 0;
}

/* The made fissure is an ellipse of 10 by 4.5 mm, cut from a coarse sheet: a face is left out where its corner lies within. */
static void rooted_beyond_the_opening(void **state)
{
	const struct made *m = *state;
	int count[2][3] = { { 0 } };
	for (int i = 0; i < m->hairs.n; i++) {
		const struct hair *h = &m->hairs.hair[i];
		const struct hair_frame f = hair_frame_of(h, &m->rig, (const float(*)[3])m->rig.rest);
		const double x = (double)f.root[0] - m->rig.globe[h->side].center[0], y = (double)f.root[1] - m->rig.globe[h->side].center[1];
		count[h->side][h->kind]++;
		if (h->kind == HAIR_BROW) {
			assert_true(y > 8 && y < 28 && fabs(x) < 28);
			continue;
		}
		const double out = hypot(x / 10, y / 4.5);
		if (!((h->kind == HAIR_UPPER) == (y > 0) && out > 0.9 && out < 2.2))
			fail_msg("a lash at %g, %g mm", x, y);
		NEAR(vec_norm((double[]){ (double)f.off[0], (double)f.off[1], (double)f.off[2] }), 1, 1e-5);
		NEAR(f.off[0] * f.up[0] + f.off[1] * f.up[1] + f.off[2] * f.up[2], 0, 1e-5);
		assert_true(f.up[1] > 0 && f.along[0] * (h->side ? -1 : 1) > 0);
	}
	for (int side = 0; side < 2; side++) {
		print_message("hairs: %d, %d on lids, %d of a brow\n", count[side][0], count[side][1], count[side][2]);
		assert_true(count[side][HAIR_UPPER] > 60 && count[side][HAIR_LOWER] > 36 && count[side][HAIR_BROW] > 150);
	}
}

/* Share of lashes that skin hides a part of from the side on which they stand, in a pose. */
static double through(const struct made *m, const float (*x)[3])
{
	struct ray_scene *skin = ray_scene_new(m->rig.n, x, m->face.skin.n_faces, (const int32_t(*)[3])m->rig.faces);
	int n = 0, bad = 0;
	for (int i = 0; i < m->hairs.n; i++) {
		const struct hair *h = &m->hairs.hair[i];
		float p[HAIR_LASH_POINTS][3];
		if (h->kind == HAIR_BROW)
			continue;
		hair_place(p, &m->hairs, h, &m->rig, x);
		bool cut = false;
		for (int k = 1; k + 1 < h->n; k++) {
			double d[3] = { (double)(p[k + 1][0] - p[k][0]), (double)(p[k + 1][1] - p[k][1]), (double)(p[k + 1][2] - p[k][2]) }, len = vec_norm(d);
			const float dir[3] = { (float)(d[0] / len), (float)(d[1] / len), (float)(d[2] / len) };
			cut = cut || ray_blocked(skin, p[k], dir, 0, (float)len);
		}
		bad += cut;
		n++;
	}
	ray_scene_free(skin);
	return (double)bad / n;
}

static void none_through_the_skin(void **state)
{
	const struct made *m = *state;
	struct deform *deform = deform_new(&m->rig);
	float (*x)[3] = calloc((size_t)m->rig.n, sizeof *x);
	const double pose[][3] = { { 0, 0, 1 }, { 0, 0, 0 }, { 15, 10, 1 }, { -15, -15, 1 } };
	for (int i = 0; i < (int)(sizeof pose / sizeof *pose); i++) {
		double c[12] = { 0 }, e[RIG_COMPONENTS], turn[2][3][3];
		drive_look(c, &m->rig, pose[i][0], pose[i][1], pose[i][2]);
		rig_components(e, &m->rig, c);
		rig_globes_turned(turn, &m->rig, c);
		deform_rest(deform, x, 0);
		deform_pose(deform, e, (const double(*)[3][3])turn, x, 0);
		const double share = through(m, (const float(*)[3])x);
		print_message("through the skin: %.1f %% of the lashes\n", 100 * share);
		assert_true(share < (i ? 0.02 : 1e-9));  // at rest none
	}
	free(x);
	deform_free(deform);
}

/* A root that turns about the globe takes its hair with it, stiff. */
static void hairs_turn_with_their_roots(void **state)
{
	const struct made *m = *state;
	float (*x)[3] = calloc((size_t)m->rig.n, sizeof *x), was[HAIR_LASH_POINTS][3], now[HAIR_LASH_POINTS][3];
	const double a = -0.4;
	for (int i = 0; i < m->hairs.n; i++) {
		const struct hair *h = &m->hairs.hair[i];
		const double *o = m->rig.globe[h->side].center;
		for (int k = 0; k < m->rig.n; k++) {
			const double y = (double)m->rig.rest[k][1] - o[1], z = (double)m->rig.rest[k][2] - o[2];
			x[k][0] = m->rig.rest[k][0];
			x[k][1] = (float)(o[1] + cos(a) * y - sin(a) * z);
			x[k][2] = (float)(o[2] + sin(a) * y + cos(a) * z);
		}
		hair_place(was, &m->hairs, h, &m->rig, (const float(*)[3])m->rig.rest);
		hair_place(now, &m->hairs, h, &m->rig, (const float(*)[3])x);
		for (int k = 0; k < h->n; k++) {
			const double y = (double)was[k][1] - o[1], z = (double)was[k][2] - o[2];
			NEAR(now[k][0], was[k][0], 1e-3);
			NEAR(now[k][1], o[1] + cos(a) * y - sin(a) * z, 1e-3);
			NEAR(now[k][2], o[2] + sin(a) * y + cos(a) * z, 1e-3);
		}
		i += i < 20 ? 0 : 17;
	}
	free(x);
}

static void strands_are_as_thick_as_hairs(void **state)
{
	const struct made *m = *state;
	const int n = strands_count(&m->hairs);
	float (*x)[3] = calloc((size_t)n, sizeof *x), (*normal)[3] = calloc((size_t)n, sizeof *normal), point[HAIR_LASH_POINTS][3];
	strands_place(x, normal, &m->hairs, &m->rig, (const float(*)[3])m->rig.rest);
	for (int i = 0, row = 0; i < m->hairs.n; i++) {
		const struct hair *h = &m->hairs.hair[i];
		const int sides = h->kind == HAIR_BROW ? 2 : 3;
		hair_place(point, &m->hairs, h, &m->rig, (const float(*)[3])m->rig.rest);
		for (int k = 0; k < h->n; k++)
			for (int s = 0; s < (k + 1 < h->n ? sides : 1); s++, row++) {
				double d[3], u[3];
				for (int c = 0; c < 3; c++) {
					d[c] = (double)x[row][c] - (double)point[k][c];
					u[c] = (double)normal[row][c];
				}
				NEAR(vec_norm(d), k + 1 < h->n ? (double)hair_half(h, k) : 0, 1e-4);
				NEAR(vec_norm(u), 1, 1e-4);
			}
		assert_true(row <= n && (i + 1 < m->hairs.n || row == n));
	}
	free(x);
	free(normal);
}

static void none_where_none_are_wanted(void **state)
{
	const struct made *m = *state;
	struct hairs h;
	struct hair_conf bare = conf;
	bool *shown = calloc((size_t)m->rig.n_faces, 1);
	bare.lash_mm = bare.brow_mm = 0;
	hairs_grow(&h, &m->rig, 0, &bare);
	assert_int_equal(h.n, 0);
	hairs_free(&h);
	hairs_grow(&h, &m->rig, shown, &conf);  // no face bears any
	assert_int_equal(h.n, 0);
	hairs_free(&h);
	free(shown);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rooted_beyond_the_opening),   cmocka_unit_test(none_through_the_skin),    cmocka_unit_test(hairs_turn_with_their_roots),
		cmocka_unit_test(strands_are_as_thick_as_hairs), cmocka_unit_test(none_where_none_are_wanted),
	};
	return cmocka_run_group_tests(tests, setup, teardown);
}
