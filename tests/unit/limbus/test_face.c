/* Both eyes of drawn faces of the training split: found as two, left and right as the picture says, of one size; of one eye, one. */
#include <string.h>

#include "base/mem.h"
#include "limbus/face/face.h"
#include "limbus/measure.h"
#include "tests/lib/conf/limbus_conf.h"
#include "tests/lib/unit.h"
#include "tests/lib/unseen/faces.h"

enum { FACES = 8 };

static int side_of(const struct ellipse *e, const struct unseen *u)
{
	const struct ellipse *l = &u->eye[FACES_LEFT].limbus, *r = &u->eye[FACES_RIGHT].limbus;
	return hypot(e->cx - l->cx, e->cy - l->cy) < hypot(e->cx - r->cx, e->cy - r->cy) ? FACE_LEFT : FACE_RIGHT;
}

static void both_eyes_of_a_face(void **state)
{
	(void)state;
	struct limbus_found *found = mem_new(2, sizeof *found);
	int both = 0, n = 0;
	for (int i = SANITISED ? FACES - 1 : 0; i < FACES; i++, n++) {
		struct unseen u = faces_make(2001, i, true, i % 2);
		const bool two = limbus_find_face(found, &u.photo, i % 2, &limbus_defaults) == 2;
		both += two;
		for (int s = 0; s < 2 && two; s++)
			assert_int_equal(side_of(&found[s].limbus.e, &u), s);
		if (two && found[0].ok && found[1].ok) {
			// Heads are not turned here: right ellipses are of one size to twice what each may be off.
			NEAR(log(found[0].limbus.e.a / found[1].limbus.e.a), 0, 0.04);
			if (found[0].has_pupil && found[1].has_pupil)
				NEAR(log(found[0].pupil.e.a / found[1].pupil.e.a), 0, 0.28);
		}
		unseen_free(&u);
	}
	// The evidence misses one in twenty eyes that are open.
	if (both < n - n / 4)
		fail_msg("%d of %d faces have both eyes", both, n);
	free(found);
}

static struct photo cut(const struct photo *photo, const struct ellipse *e)
{
	struct photo out = *photo;
	const int x0 = (int)fmax(e->cx - 4 * e->a, 0), y0 = (int)fmax(e->cy - 3 * e->a, 0);
	out.width = (int)fmin(e->cx + 4 * e->a, photo->width) - x0;
	out.height = (int)fmin(e->cy + 3 * e->a, photo->height) - y0;
	out.rgb = mem_array((size_t)out.width * (size_t)out.height * 3, sizeof *out.rgb);
	for (int y = 0; y < out.height; y++)
		memcpy(out.rgb + 3L * y * out.width, photo->rgb + 3 * ((long)(y + y0) * photo->width + x0), 3 * sizeof *out.rgb * (size_t)out.width);
	return out;
}

/* A picture of one eye is that eye, to the byte as limbus_find has it. */
static void one_eye_is_one(void **state)
{
	(void)state;
	struct limbus_found *found = mem_new(3, sizeof *found);
	for (int i = 0; i < (SANITISED ? 1 : FACES / 2); i++) {
		struct unseen u = faces_make(2001, i, true, false);
		struct photo one = cut(&u.photo, &u.eye[FACES_LEFT].limbus);
		assert_int_equal(limbus_find_face(found, &one, false, &limbus_defaults), 1);
		limbus_find(&found[2], &one, 0, &limbus_defaults);
		assert_memory_equal(&found[0].limbus.e, &found[2].limbus.e, sizeof found[0].limbus.e);
		assert_int_equal(found[0].ok, found[2].ok);
		photo_free(&one);
		unseen_free(&u);
	}
	free(found);
}

/* One eye marked: two records, the marked one where the mark is and by hand or near it; the other is the other eye, or says that it was not found. */
static void a_mark_of_one_eye(void **state)
{
	(void)state;
	struct limbus_record *record = mem_new(2, sizeof *record);
	struct unseen u = faces_make(2001, 1, true, false);
	const struct ellipse *l = &u.eye[FACES_LEFT].limbus;
	const struct limbus_mark mark[2] = { [FACE_LEFT] = { .hint = (const double[3]){ l->cx, l->cy, l->a } } };
	const struct camera_keys keys = { .focal_px = NAN, .focal_mm = NAN, .sensor_mm = NAN, .center_px = { NAN, NAN } };
	const struct limbus_camera known = { .keys = &keys, .focal_px = NAN };
	const struct eye eye = { .cornea_radius = 7.8, .cornea_asphericity = 0.75, .index = 1.336, .limbus_radius = 5.85, .limbus_aspect = 1, .iris_depth = 3.3 };
	assert_int_equal(limbus_measure_face(record, &u.photo, mark, false, &known, &eye, &limbus_defaults, &pose_defaults), 2);
	assert_true(record[FACE_LEFT].ok);
	assert_true(hypot(record[FACE_LEFT].view.limbus.cx - l->cx, record[FACE_LEFT].view.limbus.cy - l->cy) < 0.35 * l->a);
	if (record[FACE_RIGHT].ok)
		assert_int_equal(side_of(&record[FACE_RIGHT].view.limbus, &u), FACE_RIGHT);
	else
		assert_true(*record[FACE_RIGHT].reason);
	unseen_free(&u);
	free(record);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(both_eyes_of_a_face),
		cmocka_unit_test(one_eye_is_one),
		cmocka_unit_test(a_mark_of_one_eye),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
