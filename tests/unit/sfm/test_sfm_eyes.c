/* Eyes from faces found in several pictures: made-up findings, most of them wrong; and a drawn head of known eyes,
 * in which OpenCV's cascades look for them. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_face.h"
#include "math/rng.h"
#include "math/vec.h"
#include "sfm/head/sfm_eyes.h"
#include "tests/lib/scenes/drawn_head.h"
#include "tests/lib/scenes/sfm_scene.h"
#include "tests/lib/unit.h"

enum { VIEWS = 12, WIDTH = 480, HEIGHT = 640 };

static double apart(const double a[3], const double b[3])
{
	double d[3];
	vec_add(d, a, -1, b);
	return vec_norm(d);
}

/* Findings at random places of the picture. */
static struct sfm_face nonsense(struct rng *rng, int image)
{
	struct sfm_face f = { .image = image };
	double x = rng_range(rng, 100, 900), y = rng_range(rng, 100, 700), w = rng_range(rng, 40, 120);
	memcpy(f.eye, (double[2][2]){ { x + w, y }, { x, y } }, sizeof f.eye);
	f.mouth[0] = x + 0.5 * w;
	f.mouth[1] = y + w;
	return f;
}

/* Two findings a picture, one of them right in seven pictures of twelve. */
static void most_agree(void **state)
{
	(void)state;
	static const double eye[2][3] = { { 0.3, 0.2, 0.5 }, { 0.5, 0.25, -0.1 } }, mouth[3] = { 0.5, -0.5, 0.3 };
	struct colmap_model m;
	struct rng rng = { 5 };
	sfm_scene(&m, VIEWS, 20, 1);
	for (int round = 0; round < 20; round++) {
		struct sfm_face faces[2 * VIEWS];
		struct sfm_eyes at;
		bool agrees[2 * VIEWS];
		for (int i = 0; i < VIEWS; i++) {
			faces[2 * i] = nonsense(&rng, i);
			faces[2 * i + 1] = nonsense(&rng, i);
			double focal;
			for (int e = 0; e < 2 && i < 7; e++) {
				assert_true(sfm_project(faces[2 * i].eye[e], &focal, &m, i, eye[e]));
				for (int k = 0; k < 2; k++)
					faces[2 * i].eye[e][k] += 3 * rng_normal(&rng);
			}
			if (i < 7)
				assert_true(sfm_project(faces[2 * i].mouth, &focal, &m, i, mouth));
			// Found in six of the seven, in one of them beside it; in the nonsense, too.
			faces[2 * i].mouth_found = i != 3;
			faces[2 * i + 1].mouth_found = true;
			if (i == 5)
				faces[2 * i].mouth[0] += 200;
		}
		assert_true(sfm_eyes(&at, agrees, &m, 2 * VIEWS, faces, 3, 0.2));
		assert_true(at.n >= 6);  // a view along the line of the eyes may lose by noise
		for (int i = 0; i < VIEWS; i++)
			assert_false(agrees[2 * i + 1]);
		// 3 px at 240 px a unit, from six cameras or more.
		NEAR(apart(at.eye[0], eye[0]), 0, 0.025);
		NEAR(apart(at.eye[1], eye[1]), 0, 0.025);
		assert_int_equal(at.mouths, 5);
		NEAR(apart(at.mouth, mouth), 0, 1e-6);
	}
	colmap_free(&m);
}

/* Where no picture shows a face three do not agree; and one or two pictures are never enough. */
static void none(void **state)
{
	(void)state;
	struct colmap_model m;
	struct rng rng = { 6 };
	int wrong = 0;
	sfm_scene(&m, VIEWS, 20, 1);
	for (int round = 0; round < 100; round++) {
		struct sfm_face faces[VIEWS];
		struct sfm_eyes at;
		bool agrees[VIEWS];
		for (int i = 0; i < VIEWS; i++)
			faces[i] = nonsense(&rng, i);
		wrong += sfm_eyes(&at, agrees, &m, VIEWS, faces, 3, 0.2);
		assert_false(sfm_eyes(&at, agrees, &m, 2, faces, 3, 0.2));
		assert_false(sfm_eyes(&at, agrees, &m, 0, faces, 3, 0.2));
	}
	colmap_free(&m);
	// A finding in every picture and a right one in none happens to no set of photographs.
	assert_true(wrong <= 2);
}

/* The picture after a quarter turn anticlockwise: turned once clockwise it stands upright. */
static void lay_down(uint8_t *out, const uint8_t *grey)
{
	for (int y = 0; y < HEIGHT; y++)
		for (int x = 0; x < WIDTH; x++)
			out[(WIDTH - 1 - x) * HEIGHT + y] = grey[y * WIDTH + x];
}

static void a_head(void **state)
{
	(void)state;
	struct drawn_head head;
	struct err err = { 0 };
	struct cv_face_finder *finder;
	struct colmap_model m = { mem_new(1, sizeof *m.cameras), mem_new(9, sizeof *m.images), 0, 1, 9, 0 };
	if (!cv_face_open(&finder, &err)) {
		print_message("%s: left out\n", err.msg);
		colmap_free(&m);
		skip();
	}
	assert_true(drawn_head_load(&head, &err));
	m.cameras[0] = (struct colmap_camera){ 1, COLMAP_SIMPLE_PINHOLE, WIDTH, HEIGHT, { 1100, WIDTH / 2, HEIGHT / 2 } };
	uint8_t *rgb = mem_new(3 * WIDTH * HEIGHT, 1), *grey = mem_new(WIDTH * HEIGHT, 1), *lying = mem_new(WIDTH * HEIGHT, 1);
	struct sfm_face faces[64];
	struct sfm_eyes at;
	bool agrees[64];
	int n = 0;
	for (int i = 0; i < 9; i++) {
		struct cv_face found[4], again[4];
		double R[3][3];
		int k, l;
		m.images[i] = (struct colmap_image){ .id = (uint32_t)i + 1, .name = mem_printf("%d", i), .seen = mem_new(1, sizeof *m.images->seen) };
		drawn_head_camera(R, m.images[i].t, (i % 5 - 2) * 0.21, (i / 5 - 0.5) * 0.2, 600);
		sfm_quaternion(m.images[i].q, R);
		drawn_head_draw(rgb, &head, R, m.images[i].t, 1100, WIDTH, HEIGHT);
		for (int p = 0; p < WIDTH * HEIGHT; p++)
			grey[p] = rgb[3 * p + 1];
		assert_true(cv_face_find(&k, found, 4, finder, grey, WIDTH, HEIGHT, 0, &err));
		for (int j = 0; j < k; j++) {
			struct sfm_face *f = &faces[n++];
			f->image = i;
			memcpy(f->eye, found[j].eye, sizeof f->eye);
			memcpy(f->mouth, found[j].mouth, sizeof f->mouth);
			f->mouth_found = found[j].mouth_found;
		}
		// Held on its side: nothing upright, the same face after a turn.
		lay_down(lying, grey);
		assert_true(cv_face_find(&l, again, 4, finder, lying, HEIGHT, WIDTH, 0, &err));
		assert_int_equal(l, 0);
		assert_true(cv_face_find(&l, again, 4, finder, lying, HEIGHT, WIDTH, 1, &err));
		assert_int_equal(l, k);
		for (int j = 0; j < k; j++)
			for (int e = 0; e < 2; e++) {
				NEAR(again[j].eye[e][0], found[j].eye[e][1], 1e-9);
				NEAR(again[j].eye[e][1], WIDTH - found[j].eye[e][0], 1e-9);
			}
	}
	assert_true(sfm_eyes(&at, agrees, &m, n, faces, 3, 0.2));
	assert_true(at.n >= 6);
	// What is found is the middle of the opening, some 13 mm before the eyeball's centre: a cascade locates it to a tenth of the
	// eyes' distance in one picture.
	for (int e = 0; e < 2; e++) {
		double front[3] = { drawn_head_ball[e][0], drawn_head_ball[e][1], drawn_head_ball[e][2] + 13 };
		assert_true(apart(at.eye[e], front) < 6);
	}
	// The lips meet at (0, 664, 158); the cascade's window of a mouth is wider than it and reaches to the chin.
	assert_true(at.mouths >= 6);
	assert_true(fabs(at.mouth[0]) < 5 && fabs(at.mouth[1] - 664) < 15 && fabs(at.mouth[2] - 158) < 25);
	NEAR(apart(at.eye[0], at.eye[1]) / 61.6, 1, 0.06);
	cv_face_close(finder);
	drawn_head_free(&head);
	free(rgb);
	free(grey);
	free(lying);
	colmap_free(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(most_agree),
		cmocka_unit_test(none),
		cmocka_unit_test(a_head),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
