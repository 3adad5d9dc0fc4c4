#include "tests/lib/unseen/unseen.h"

#include <math.h>

#include "base/mem.h"
#include "tests/lib/unseen/unseen_impl.h"

struct photo unseen_photo(const uint8_t *rgb, int width, int height)
{
	struct photo photo = photo_of_bytes(rgb, width, height);
	photo.kind = PHOTO_JPEG;
	photo.exif = (struct photo_exif){ .orientation = 1, .focal_px = NAN, .focal_mm = NAN, .focal_35mm = NAN };
	return photo;
}

/* width 0: any. */
static struct unseen_frame frame_make(struct rng *rng, int width, int height)
{
	static const double shapes[5] = { 4.0 / 3, 3.0 / 2, 1, 3.0 / 4, 16.0 / 9 };
	const double longer = exp(rng_range(rng, log(300), log(1600))), shape = shapes[rng_below(rng, 5)];
	struct unseen_frame f = { .width = (int)(shape > 1 ? longer : longer * shape), .height = (int)(shape > 1 ? longer / shape : longer) };
	if (width) {
		f.width = width;
		f.height = height;
	}
	const double shorter = fmin(f.width, f.height), most = fmin(500, 0.46 * shorter);
	const double least = rng_below(rng, 2) ? fmax(30, 0.12 * shorter) : 30;
	f.radius = exp(rng_range(rng, log(least), log(fmax(most, least))));
	const double margin = 1.05 * f.radius;
	f.x = fmin(fmax(f.width * (0.5 + 0.15 * rng_normal(rng)), margin), f.width - margin);
	f.y = fmin(fmax(f.height * (0.5 + 0.15 * rng_normal(rng)), margin), f.height - margin);
	f.turn = rng_below(rng, 7) ? 0.15 * rng_normal(rng) : rng_range(rng, -M_PI, M_PI);
	f.mirrored = rng_below(rng, 2);
	return f;
}

struct unseen unseen_sized(uint64_t seed, int i, int width, int height)
{
	struct rng rng = { seed * 0x9e3779b97f4a7c15 + (uint64_t)i };
	rng_bits(&rng);
	struct unseen u = { 0 };
	if (unseen_kept(&u, seed, i, width, height))
		return u;
	for (bool made = false; !made;) {
		const struct unseen_frame f = frame_make(&rng, width, height);
		const uint64_t number = rng_bits(&rng) >> 20;
		made = i % 10 < 7 ? unseen_draw(&u, number, &f) : unseen_cast(&u, &rng, &f);
		if (!made)
			unseen_free(&u);
	}
	unseen_keep(&u, seed, i, width, height);
	return u;
}

struct unseen unseen_make(uint64_t seed, int i)
{
	return unseen_sized(seed, i, 0, 0);
}

void unseen_free(struct unseen *u)
{
	photo_free(&u->photo);
	*u = (struct unseen){ 0 };
}
