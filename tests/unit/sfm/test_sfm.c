/* Which pictures overlap, which points are the same, where the head is: against all-with-all in double, and closed forms. */
#include "base/mem.h"
#include "math/rng.h"
#include "math/vec.h"
#include "sfm/head/sfm_frame.h"
#include "sfm/match/frames.h"
#include "sfm/match/match.h"
#include "tests/lib/scenes/sfm_scene.h"
#include "tests/lib/unit.h"

/* A descriptor of length 512 near a given one (null: anywhere). */
static void draw(uint8_t out[SIFT_DIM], const uint8_t *near, double noise, struct rng *rng)
{
	double v[SIFT_DIM], sum = 0;
	for (int i = 0; i < SIFT_DIM; i++) {
		v[i] = near ? fabs(near[i] + noise * rng_normal(rng)) : fabs(rng_normal(rng)) * (rng_uniform(rng) < 0.4 ? 1 : 0.1);
		sum += v[i] * v[i];
	}
	for (int i = 0; i < SIFT_DIM; i++)
		out[i] = (uint8_t)fmin(255, lround(512 * v[i] / sqrt(sum)));
}

static struct sfm_features features(int n, struct rng *rng)
{
	struct sfm_features f = { n, mem_new((size_t)n, SIFT_DIM), mem_new((size_t)n, sizeof(float)) };
	for (int i = 0; i < n; i++) {
		draw(f.descriptors[i], 0, 0, rng);
		f.scale[i] = (float)rng_range(rng, 1, 20);
	}
	return f;
}

/* The first `same` of b are those of a, disturbed. */
static void share(struct sfm_features *b, const struct sfm_features *a, int same, double noise, struct rng *rng)
{
	for (int i = 0; i < same; i++) {
		draw(b->descriptors[i], a->descriptors[i], noise, rng);
		b->scale[i] = a->scale[i];
	}
}

static double angle(const uint8_t a[SIFT_DIM], const uint8_t b[SIFT_DIM])
{
	double dot = 0;
	for (int i = 0; i < SIFT_DIM; i++)
		dot += (double)a[i] * b[i];
	return acos(fmin(1, dot / (512.0 * 512)));
}

/* Lowe's test by definition: nearest and second nearest by sorting nothing, in double. */
static int nearest(const uint8_t d[SIFT_DIM], const struct sfm_features *f, const struct sfm_match_conf *conf)
{
	double best = 9, second = 9;
	int at = -1;
	for (int j = 0; j < f->n; j++) {
		double a = angle(d, f->descriptors[j]);
		if (a < best) {
			second = best;
			best = a;
			at = j;
		} else if (a < second)
			second = a;
	}
	second = f->n > 1 ? second : M_PI / 2;
	return best <= conf->max_distance && best < conf->max_ratio * second ? at : -1;
}

static void test_match(void **state)
{
	(void)state;
	const struct sfm_match_conf conf = { 0.8, 0.7 };
	// Around the size of a block, and pictures with next to nothing.
	static const int sizes[][2] = { { 300, 257 }, { 1, 40 }, { 40, 1 }, { 0, 5 }, { 256, 256 } };
	for (int c = 0; c < COUNT(sizes); c++) {
		struct rng rng = { (uint64_t)c + 3 };
		struct sfm_features a = features(sizes[c][0], &rng), b = features(sizes[c][1], &rng);
		int same = a.n < b.n ? a.n / 2 : b.n / 2;
		share(&b, &a, same, 12, &rng);
		struct sfm_matches m;
		sfm_match(&m, &a, &b, &conf);
		int n = 0;
		for (int i = 0; i < a.n; i++) {
			int j = nearest(a.descriptors[i], &b, &conf);
			if (j < 0 || nearest(b.descriptors[j], &a, &conf) != i)
				continue;
			assert_true(n < m.n && m.index[n][0] == (uint32_t)i && m.index[n][1] == (uint32_t)j);
			n++;
		}
		assert_int_equal(n, m.n);
		assert_true(n >= same * 9 / 10);
		free(m.index);
		sfm_features_free(&a);
		sfm_features_free(&b);
	}
}

static const struct sfm_overlap_conf overlap = { 100, 10, 2, 0, { 0.8, 0.7 } };

/* A chain of pictures, each sharing half with the next: those pairs are found, no others but the best few. */
static void test_overlap(void **state)
{
	(void)state;
	enum { N = 12 };
	struct rng rng = { 8 };
	struct sfm_features f[N];
	struct sfm_overlap_conf conf = overlap;
	int n;
	for (int i = 0; i < N; i++) {
		f[i] = features(100, &rng);
		for (int k = 0; i && k < 40; k++)
			draw(f[i].descriptors[k], f[i - 1].descriptors[60 + k], 10, &rng);
	}
	struct sfm_pair *pairs = sfm_overlap(&n, N, f, 0, &conf);
	int chain = 0;
	for (int i = 0; i < n; i++) {
		assert_true(pairs[i].a < pairs[i].b);
		chain += pairs[i].b == pairs[i].a + 1 && pairs[i].score >= 20;
	}
	assert_int_equal(chain, N - 1);
	assert_true(n <= N - 1 + 2 * N);
	assert_true(sfm_is_sequence(N, pairs, n));
	free(pairs);
	// New pictures alone: pairs without one are not looked at.
	pairs = sfm_overlap(&n, N, f, N - 1, &conf);
	assert_true(n >= 1 && n <= 2);
	for (int i = 0; i < n; i++)
		assert_int_equal(pairs[i].b, N - 1);
	free(pairs);
	// Neighbours are kept whatever they share; a small set keeps every pair.
	conf.neighbours = 3;
	pairs = sfm_overlap(&n, N, f, 0, &conf);
	assert_true(n >= 3 * N - 6);
	free(pairs);
	conf.always = N;
	pairs = sfm_overlap(&n, N, f, 0, &conf);
	assert_int_equal(n, N * (N - 1) / 2);
	free(pairs);
	// In another order they are no sequence.
	struct sfm_features mixed[N];
	for (int i = 0; i < N; i++)
		mixed[i] = f[i * 5 % N];
	pairs = sfm_overlap(&n, N, mixed, 0, &overlap);
	assert_false(sfm_is_sequence(N, pairs, n));
	free(pairs);
	for (int i = 0; i < N; i++)
		sfm_features_free(&f[i]);
}

/* The cameras of the scene look at the origin, its points fill a ball of radius 1 evenly. */
static void test_subject(void **state)
{
	(void)state;
	struct colmap_model m;
	struct sfm_subject s;
	struct err err = { 0 };
	sfm_scene(&m, 9, 2000, 1);
	assert_true(sfm_subject(&s, &m, &err));
	NEAR(vec_norm(s.center), 0, 1e-9);
	// Half of a ball's points lie within the cube root of a half of its radius; 2000 of them: to 2 %.
	NEAR(s.radius, SFM_SUBJECT_REACH * cbrt(0.5), 0.04);
	// All from one place: every camera on one axis.
	for (int i = 0; i < m.n_images; i++)
		for (int k = 0; k < 4; k++)
			m.images[i].q[k] = m.images[0].q[k];
	assert_false(sfm_subject(&s, &m, &err));
	ERR_HAS(err, "all look the same way");
	colmap_free(&m);
}

/* A point comes back from its observations; its sigma is what repeated noise scatters by. */
static void test_triangulate(void **state)
{
	(void)state;
	enum { VIEWS = 5, TRIALS = 400 };
	struct colmap_model m;
	struct err err = { 0 };
	struct rng rng = { 77 };
	const double truth[3] = { 0.3, -0.2, 0.4 }, noise = 0.5;
	double square = 0, sigma = 0, predicted = 0;
	sfm_scene(&m, VIEWS, 30, 6);
	for (int t = 0; t < TRIALS; t++) {
		struct sfm_sight sights[VIEWS];
		double xyz[3], error[3];
		for (int i = 0; i < VIEWS; i++) {
			struct camera camera;
			double focal[2], R[3][3], p[3];
			assert_true(colmap_to_camera(&camera, focal, &m.cameras[0], &err));
			colmap_rotation(R, m.images[i].q);
			mat_vec(p, R, truth);
			for (int k = 0; k < 3; k++)
				p[k] += m.images[i].t[k];
			sights[i].image = i;
			assert_true(camera_project(sights[i].px, &camera, p));
			for (int k = 0; k < 2 && t; k++)
				sights[i].px[k] += noise * rng_normal(&rng);
		}
		assert_true(sfm_triangulate(xyz, &sigma, &m, VIEWS, sights, 1e-6, &err));
		vec_add(error, xyz, -1, truth);
		if (!t)
			NEAR(vec_norm(error), 0, 1e-9);
		square += vec_dot(error, error) / TRIALS;
		predicted += sigma * sigma / TRIALS;
	}
	// 400 trials determine a standard deviation to 1 / sqrt(2 * 3 * 400) = 2 %; each sigma itself comes from 7 degrees of freedom.
	NEAR(sqrt(predicted / square), 1, 0.1);
	struct sfm_sight one = { 0, { 500, 400 } };
	double xyz[3];
	assert_false(sfm_triangulate(xyz, &sigma, &m, 1, &one, 1, &err));
	colmap_free(&m);
}

static void test_scale(void **state)
{
	(void)state;
	double sigma;
	const struct sfm_length agree[] = { { 2, 100, 0.01 }, { 4, 200, 0.01 }, { 1, 50, 0.01 }, { 3, 150, 0.01 } };
	NEAR(sfm_scale(&sigma, 4, agree), 50, 1e-9);
	NEAR(sigma, 0.005, 1e-9);
	// Two that differ by 20 % with claimed sigmas of 1 %: the claim is not believed.
	const struct sfm_length differ[] = { { 1, 100, 0.01 }, { 1, 120, 0.01 } };
	NEAR(sfm_scale(&sigma, 2, differ), sqrt(12000), 1e-9);
	NEAR(sigma, log(1.2) / 2, 1e-6);
	// The exact one decides.
	const struct sfm_length unequal[] = { { 1, 100, 0.002 }, { 1, 120, 0.2 } };
	NEAR(sfm_scale(&sigma, 2, unequal), 100, 0.02);
}

/* Eyes and mouth of a head that is turned and scaled: its own axes come back, and a camera sees what it saw. */
static void test_frame(void **state)
{
	(void)state;
	struct colmap_model m;
	struct rng rng = { 4 };
	sfm_scene(&m, 6, 30, 2);
	for (int trial = 0; trial < 50; trial++) {
		double q[4], T[3][3], norm = 0;
		for (int k = 0; k < 4; k++) {
			q[k] = rng_normal(&rng);
			norm += q[k] * q[k];
		}
		for (int k = 0; k < 4; k++)
			q[k] /= sqrt(norm);
		colmap_rotation(T, q);  // world_from_head, 25 mm a unit
		const double eye_left[3] = { 31, 0, 0 }, eye_right[3] = { -31, 0, 0 }, lips[3] = { 0, -70, 0 }, offset[3] = { 0.4, -0.3, 0.2 };
		double left[3], right[3], mouth[3], head[3], cam_from_head[4][4];
		mat_vec(left, T, eye_left);
		mat_vec(right, T, eye_right);
		mat_vec(mouth, T, lips);
		for (int k = 0; k < 3; k++) {
			left[k] = left[k] / 25 + offset[k];
			right[k] = right[k] / 25 + offset[k];
			mouth[k] = mouth[k] / 25 + offset[k];
		}
		struct sfm_frame f;
		sfm_frame_eyes(&f, &m, left, right, mouth, 25);
		sfm_to_head(head, &f, left);
		for (int k = 0; k < 3; k++)
			NEAR(head[k], eye_left[k], 1e-9);
		sfm_to_head(head, &f, mouth);
		for (int k = 0; k < 3; k++)
			NEAR(head[k], lips[k], 1e-9);
		// A point through the head's frame and through the world's lands on the same ray, 25 times as far.
		sfm_cam_from_head(cam_from_head, &f, &m.images[trial % 6]);
		double R[3][3], p[3];
		colmap_rotation(R, m.images[trial % 6].q);
		mat_vec(p, R, mouth);
		for (int i = 0; i < 3; i++)
			NEAR(vec_dot(cam_from_head[i], head) + cam_from_head[i][3], 25 * (p[i] + m.images[trial % 6].t[i]), 1e-7);
	}
	// From the cameras alone: those of the scene stand upright on a circle in the plane of x and z.
	struct sfm_subject s = { { 0, 0, 0 }, 1 };
	struct sfm_frame f;
	sfm_frame_cameras(&f, &m, &s, 10);
	assert_true(f.R[1][1] > 0.99);
	colmap_free(&m);
}

/* A camera that pans evenly, rests for thousands of frames, and pans on: every third frame of the pan is sharp. */
static void test_frames(void **state)
{
	(void)state;
	enum { N = 5000, PAN = 60, WANT = 20 };
	static double sharpness[N], change[N];
	long chosen[WANT];
	for (int i = 0; i < N; i++) {
		bool moves = i < PAN || i >= N - PAN;
		sharpness[i] = moves && i % 3 == 1 ? 9 : 1;
		change[i] = i && moves ? 2 : 0;
	}
	int n = sfm_choose_frames(chosen, WANT, N, sharpness, change, 0.7);
	assert_in_range(n, WANT - 1, WANT);
	int resting = 0;
	for (int i = 0; i < n; i++) {
		assert_true(!i || chosen[i] > chosen[i - 1]);
		resting += chosen[i] >= PAN && chosen[i] < N - PAN;
		assert_true(sharpness[chosen[i]] == 9);
	}
	// The rest is one stretch's part, however long it lasts.
	assert_in_range(resting, 0, 1);
	// Equal shares of the change: 12 a stretch are 6 frames.
	for (int i = 1; i < n; i++)
		if (chosen[i] < PAN)
			assert_in_range(chosen[i] - chosen[i - 1], 1, 12);
	for (int i = 0; i < N; i++)
		change[i] = 0;
	sharpness[77] = 10;
	assert_int_equal(sfm_choose_frames(chosen, WANT, N, sharpness, change, 0.7), 1);
	assert_int_equal(chosen[0], 77);
	assert_int_equal(sfm_choose_frames(chosen, WANT, 1, sharpness, change, 0.7), 1);
	assert_int_equal(sfm_choose_frames(chosen, WANT, 0, sharpness, change, 0.7), 0);
	// Noise of a tripod: fewer stretches than it is asked for, never more.
	for (int i = 0; i < N; i++)
		change[i] = 0.0005;
	assert_in_range(sfm_choose_frames(chosen, WANT, N, sharpness, change, 0.7), 1, 4);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(test_match),       cmocka_unit_test(test_overlap), cmocka_unit_test(test_subject),
		cmocka_unit_test(test_triangulate), cmocka_unit_test(test_scale),   cmocka_unit_test(test_frame), cmocka_unit_test(test_frames),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
