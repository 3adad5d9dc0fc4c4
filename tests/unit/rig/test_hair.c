/* Lashes and brows of a made face: where they are rooted, that none goes through the skin, that they move with it, and their triangles. */
#include "math/vec.h"
#include "mesh/ray.h"
#include "rig/glb/strands.h"
#include "rig/glb/tears.h"
#include "rig/hair/hair.h"
#include "tests/lib/scenes/driven.h"
#include "tests/lib/unit.h"

static const struct hair_conf conf = { .lash_mm = 9, .brow_mm = 8, .lashes = 100, .brow_hairs = 200, .margin_mm = 1.1 };

static int setup(void **state)
{
	struct driven *m = calloc(1, sizeof *m);
	struct err err = { 0 };
	*state = m;
	return driven_make(m, &conf, &err) ? 0 : 1;
}

static int teardown(void **state)
{
	driven_free(*state);
	free(*state);
	return 0;
}

/* The made fissure is an ellipse of 10 by 4.5 mm, cut from a coarse sheet: a face is left out where its corner lies within. */
static void rooted_beyond_the_opening(void **state)
{
	const struct driven *m = *state;
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
static double through(const struct driven *m, const float (*x)[3])
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
	const struct driven *m = *state;
	float (*x)[3] = calloc((size_t)m->rig.n, sizeof *x);
	const double pose[][3] = { { 0, 0, 1 }, { 0, 0, 0 }, { 15, 10, 1 }, { -15, -15, 1 } };
	for (int i = 0; i < (int)(sizeof pose / sizeof *pose); i++) {
		double turn[2][3][3];
		driven_pose(x, turn, m, pose[i][0], pose[i][1], pose[i][2]);
		const double share = through(m, (const float(*)[3])x);
		print_message("through the skin: %.1f %% of the lashes\n", 100 * share);
		assert_true(share < (i ? 0.02 : 1e-9));  // at rest none
	}
	free(x);
}

/* A root that turns about the globe takes its hair with it, stiff. */
static void hairs_turn_with_their_roots(void **state)
{
	const struct driven *m = *state;
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

/* A tube of three sides is as wide as a round hair in the mean over where it is seen from: its girth over pi (Cauchy). A ribbon is as wide from before. */
static void strands_are_as_thick_as_hairs(void **state)
{
	const struct driven *m = *state;
	const int n = strands_count(&m->hairs);
	float (*x)[3] = calloc((size_t)n, sizeof *x), (*normal)[3] = calloc((size_t)n, sizeof *normal), point[HAIR_LASH_POINTS][3];
	strands_place(x, normal, &m->hairs, &m->rig, (const float(*)[3])m->rig.rest);
	for (int i = 0, row = 0; i < m->hairs.n; i++) {
		const struct hair *h = &m->hairs.hair[i];
		const int sides = h->kind == HAIR_BROW ? 2 : 3;
		hair_place(point, &m->hairs, h, &m->rig, (const float(*)[3])m->rig.rest);
		for (int k = 0; k < h->n; k++) {
			const int ring = k + 1 < h->n ? sides : 1, first = row;
			double girth = 0;
			for (int s = 0; s < ring; s++, row++) {
				double d[3], u[3], side[3];
				for (int c = 0; c < 3; c++) {
					d[c] = (double)x[row][c] - (double)point[k][c];
					u[c] = (double)normal[row][c];
					side[c] = (double)x[first + (s + 1) % ring][c] - (double)x[row][c];
				}
				girth += vec_norm(side);
				if (ring < 3)
					NEAR(vec_norm(d), ring == 2 ? (double)hair_half(h, k) : 0, 1e-4);
				NEAR(vec_norm(u), 1, 1e-4);
			}
			if (ring == 3)
				NEAR(girth / M_PI, 2 * (double)hair_half(h, k), 1e-4);
		}
		assert_true(row <= n && (i + 1 < m->hairs.n || row == n));
	}
	free(x);
	free(normal);
}

static void none_where_none_are_wanted(void **state)
{
	const struct driven *m = *state;
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

/* The meniscus stands on the globe's surface, is as high as wanted in the middle, runs out at the corners, and goes where lids meet. */
static void tears_stand_on_the_eyeball(void **state)
{
	const struct driven *m = *state;
	static const double height = 0.3, over = 0.05;
	const int n = tears_count(&m->hairs);
	float (*x)[3] = calloc((size_t)m->rig.n, sizeof *x), (*at)[3] = calloc((size_t)n, sizeof *at), (*normal)[3] = calloc((size_t)n, sizeof *normal);
	assert_true(m->hairs.n_rims > 2 * HAIR_RIMS - 20 && m->hairs.n_rims <= 2 * HAIR_RIMS);
	for (int shut = 0; shut < 2; shut++) {
		double turn[2][3][3], highest = 0, widest = 0;
		driven_pose(x, turn, m, 10, 5, 1);
		for (int i = 0; i < m->hairs.n_rims && shut; i++)  // this face's lids do not meet by themselves
			for (int k = 0; k < 3; k++)
				memcpy(x[m->hairs.rim[i].vertex[1][k]], x[m->hairs.rim[i].vertex[0][0]], sizeof *x);
		tears_place(at, normal, &m->hairs, &m->rig, (const float(*)[3])x, (const double(*)[3][3])turn, height, over);
		for (int i = 0; i < n; i++) {
			const struct hair_rim *rim = &m->hairs.rim[i / TEARS_SECTION];
			const double off = rig_globe_distance(&m->rig, rim->side, (const double(*)[3])turn[rim->side], at[i]), end = fmin(rim->along, 1 - rim->along);
			assert_true(off > over && off < over + height + 0.03);
			highest = fmax(highest, off);
			double apart[3], up[3];
			for (int c = 0; c < 3; c++) {
				apart[c] = (double)at[i][c] - (double)at[i - i % TEARS_SECTION][c];
				up[c] = (double)normal[i][c];
			}
			NEAR(vec_norm(up), 1, 1e-5);
			widest = fmax(widest, vec_norm(apart));
			if (end == 0)
				NEAR(vec_norm(apart), 0, 1e-5);
		}
		print_message("tears %.3f mm high, %.3f across\n", highest - over, widest);
		assert_true(shut ? highest - over < 0.1 : fabs(highest - over - height) < 0.03 && fabs(widest - sqrt(2) * height) < 0.03);
	}
	free(x);
	free(at);
	free(normal);
}

/* Each triangle's own normal leans to the side of its vertices'. */
static void tears_look_outwards(void **state)
{
	const struct driven *m = *state;
	const int n = tears_count(&m->hairs);
	float (*at)[3] = calloc((size_t)n, sizeof *at), (*normal)[3] = calloc((size_t)n, sizeof *normal);
	uint32_t (*face)[3] = calloc(2 * (size_t)n, sizeof *face);
	double turn[2][3][3] = { { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } };
	tears_place(at, normal, &m->hairs, &m->rig, (const float(*)[3])m->rig.rest, (const double(*)[3][3])turn, 0.3, 0);
	const int faces = tears_faces(face, &m->hairs, 0);
	assert_int_equal(faces, 2 * (m->hairs.n_rims - 2) * (TEARS_SECTION - 1));
	for (int f = 0; f < faces; f++) {
		double a[3], b[3], own[3], sum = 0, flat = 0;
		for (int c = 0; c < 3; c++) {
			a[c] = (double)at[face[f][1]][c] - (double)at[face[f][0]][c];
			b[c] = (double)at[face[f][2]][c] - (double)at[face[f][0]][c];
		}
		vec_cross(own, a, b);
		for (int c = 0; c < 3; c++) {
			sum += own[c] * (double)normal[face[f][0]][c];
			flat = fmax(flat, fabs(own[c]));
		}
		assert_true(sum > 0 || flat < 1e-6);  // without area where the meniscus ends
	}
	free(at);
	free(normal);
	free(face);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rooted_beyond_the_opening),   cmocka_unit_test(none_through_the_skin),    cmocka_unit_test(hairs_turn_with_their_roots),
		cmocka_unit_test(strands_are_as_thick_as_hairs), cmocka_unit_test(none_where_none_are_wanted),
		cmocka_unit_test(tears_stand_on_the_eyeball),  cmocka_unit_test(tears_look_outwards),
	};
	return cmocka_run_group_tests(tests, setup, teardown);
}
