/* A face carried from frame to frame: a soft pattern that moves by known amounts. */
#include <math.h>
#include <string.h>

#include "math/rng.h"
#include "track/clip/carry.h"
#include "tests/lib/unit.h"

enum { WIDE = 320, HIGH = 240, WAVES = 40 };
static uint8_t picture[HIGH][WIDE];

/* Waves of 12 to 60 px, shifted; by a light that is brighter. */
static void draw(double dx, double dy, double gain)
{
	struct rng rng = { 3 };
	double wave[WAVES][3];
	for (int i = 0; i < WAVES; i++) {
		const double length = 12 + 48 * rng_uniform(&rng), way = 2 * M_PI * rng_uniform(&rng);
		wave[i][0] = 2 * M_PI / length * cos(way);
		wave[i][1] = 2 * M_PI / length * sin(way);
		wave[i][2] = 2 * M_PI * rng_uniform(&rng);
	}
	for (int y = 0; y < HIGH; y++)
		for (int x = 0; x < WIDE; x++) {
			double sum = 0;
			for (int i = 0; i < WAVES; i++)
				sum += sin(wave[i][0] * (x - dx) + wave[i][1] * (y - dy) + wave[i][2]);
			picture[y][x] = (uint8_t)fmin(fmax(gain * (120 + 8 * sum), 0), 255);
		}
}

static void moves(void **state)
{
	(void)state;
	const double by[][2] = { { 0, 0 }, { 3.3, -2.1 }, { -31, 12.5 }, { 40, 35 } };
	struct carry carry = { 0 };
	double shift[2];
	draw(0, 0, 1);
	assert_false(carry_find(shift, &carry, picture[0], WIDE, WIDE, HIGH));
	carry_keep(&carry, picture[0], WIDE, WIDE, HIGH, (double[2]){ 160, 100 }, 48);
	for (int i = 0; i < (int)(sizeof by / sizeof *by); i++) {
		draw(by[i][0], by[i][1], 1.1);
		assert_true(carry_find(shift, &carry, picture[0], WIDE, WIDE, HIGH));
		// a sixth of a large pixel (3 px)
		for (int k = 0; k < 2; k++)
			NEAR(shift[k], by[i][k], 0.5);
	}
}

/* Part of it is outside of the picture. */
static void border(void **state)
{
	(void)state;
	struct carry carry = { 0 };
	double shift[2];
	draw(0, 0, 1);
	carry_keep(&carry, picture[0], WIDE, WIDE, HIGH, (double[2]){ 30, 20 }, 48);
	draw(-9, -6, 1);
	assert_true(carry_find(shift, &carry, picture[0], WIDE, WIDE, HIGH));
	NEAR(shift[0], -9, 0.5);
	NEAR(shift[1], -6, 0.5);
}

static void gone(void **state)
{
	(void)state;
	struct carry carry = { 0 };
	double shift[2];
	draw(0, 0, 1);
	carry_keep(&carry, picture[0], WIDE, WIDE, HIGH, (double[2]){ 160, 100 }, 48);
	memset(picture, 90, sizeof picture);
	assert_false(carry_find(shift, &carry, picture[0], WIDE, WIDE, HIGH));
	draw(5000, 7000, 1);
	assert_false(carry_find(shift, &carry, picture[0], WIDE, WIDE, HIGH));
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(moves), cmocka_unit_test(border), cmocka_unit_test(gone) };
	return cmocka_run_group_tests(tests, NULL, NULL);
}
