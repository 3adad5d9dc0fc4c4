#include "tests/lib/unseen/no_eye.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "tests/evidence/other.h"
#include "tests/evidence/scene.h"
#include "tests/lib/cast/cast.h"
#include "tests/lib/unseen/unseen_impl.h"

const char *const no_eye_kind[NO_EYE_KINDS] = { "ball", "wheel", "button", "printed target", "doll", "clutter", "face without its eyes", "closed eye",
	"motion blur", "cut by the frame", "an animal's eye", "two faces" };

/* Means along a line of so many px. */
static void move(struct photo *p, double length, double turn)
{
	const long n = 3L * p->width * p->height;
	uint16_t *was = mem_array((size_t)n, sizeof *was);
	memcpy(was, p->rgb, (size_t)n * sizeof *was);
	const int steps = (int)length;
	for (int y = 0; y < p->height; y++)
		for (int x = 0; x < p->width; x++)
			for (int c = 0; c < 3; c++) {
				double sum = 0;
				for (int k = 0; k < steps; k++) {
					const double s = k - 0.5 * steps;
					const int u = (int)fmin(fmax(x + s * cos(turn), 0), p->width - 1), v = (int)fmin(fmax(y + s * sin(turn), 0), p->height - 1);
					sum += was[3 * ((long)v * p->width + u) + c];
				}
				p->rgb[3 * ((long)y * p->width + x) + c] = (uint16_t)(257 * lround(sum / steps / 257));
			}
	free(was);
}

/* A cat's or goat's eye that fills its lids. */
static struct photo animal(int width, int height, struct rng *rng)
{
	const double radius = rng_range(rng, 0.2, 0.4) * height;
	const struct cast_frame frame = { .width = width, .height = height, .radius = radius, .x = 0.5 * width, .y = 0.5 * height,
		.left = rng_below(rng, 2), .animal = true };
	struct cast_truth truth;
	uint8_t *rgb = cast_render(&truth, &frame, rng);
	struct photo photo = unseen_photo(rgb, width, height);
	free(rgb);
	return photo;
}

/* Two people beside each other. */
static struct photo faces(int width, int height, struct rng *rng)
{
	uint8_t *rgb = mem_array((size_t)width * (size_t)height, 3);
	for (int side = 0; side < 2; side++) {
		const int half = width / 2;
		// Eyes are 62 mm apart, some ten times the radius: both of one face are in its half, whichever of them is in the middle.
		const struct drawn_view view = { .radius = 0.04F * (float)half, .x = 0.5F * (float)half, .y = 0.45F * (float)height, .mirrored = rng_below(rng, 2) };
		struct drawn d = drawn_photograph(rng_bits(rng) >> 20, &view, half, height);
		for (int y = 0; y < height; y++)
			memcpy(rgb + 3 * ((long)y * width + side * half), d.rgb + 3L * y * half, 3 * (size_t)half);
		drawn_free(&d);
	}
	struct photo photo = unseen_photo(rgb, width / 2 * 2, height);
	free(rgb);
	return photo;
}

struct photo no_eye_make(uint64_t seed, int kind, int i)
{
	static const int other[NO_EYE_KINDS] = { OTHER_BALL, OTHER_WHEEL, OTHER_BUTTON, OTHER_TARGET, OTHER_DOLL, OTHER_CLUTTER, OTHER_FACE };
	struct rng rng = { (seed * 0x9e3779b97f4a7c15) ^ ((uint64_t)(1000 + 1000 * kind + i) << 20) };
	const int longer = (int)exp(rng_range(&rng, log(300), log(1000))), width = longer, height = longer * 3 / 4;
	if (kind == NO_EYE_ANIMAL)
		return animal(width, height, &rng);
	if (kind == NO_EYE_TWO_FACES)
		return faces(2 * (width / 2), height, &rng);
	const double radius = rng_range(&rng, 0.12, 0.4) * height, way = rng_range(&rng, 0, 2 * M_PI);
	uint64_t number = rng_bits(&rng) >> 20;
	struct drawn_view view = { .radius = (float)(kind == NO_EYE_FACE ? 0.3 * radius : radius), .x = 0.5F * (float)width, .y = 0.5F * (float)height, .other = other[kind] };
	if (kind == NO_EYE_CUT) {
		// Most of the limbus lies beyond a side: its centre on the edge of the frame or beyond.
		const double beyond = rng_range(&rng, 0.05, 0.4) * radius;
		view.x = rng_below(&rng, 2) ? (float)-beyond : (float)(width + beyond);
	}
	struct drawn d = drawn_photograph(number, &view, width, height);
	// Of lids the generator decides: numbers are tried until they are closed, or open.
	while (kind >= NO_EYE_CLOSED
	       && (d.n_eyes == 0 || (d.eye[0].openness > 0) == (kind == NO_EYE_CLOSED) || (kind == NO_EYE_CUT && d.n_eyes > 1))) {
		struct drawn small = { 0 };
		for (bool fits = false; !fits;) {
			const struct drawn_view middle = { .radius = 8, .x = 16, .y = 12 };
			drawn_free(&small);
			small = drawn_photograph(++number, &middle, 32, 24);
			fits = small.n_eyes > 0 && (small.eye[0].openness > 0) != (kind == NO_EYE_CLOSED);
		}
		drawn_free(&small);
		drawn_free(&d);
		d = drawn_photograph(number, &view, width, height);
	}
	struct photo photo = unseen_photo(d.rgb, width, height);
	drawn_free(&d);
	if (kind == NO_EYE_MOVED)
		move(&photo, rng_range(&rng, 0.7, 1.2) * radius, way);
	return photo;
}
