#include "tests/lib/cast/cast.h"

#include <math.h>
#include <stdlib.h>

#include "tests/lib/unseen/unseen_impl.h"

bool unseen_cast(struct unseen *u, struct rng *rng, const struct unseen_frame *f)
{
	// There is one eye and its surroundings: no more than some 100 mm of them are shown.
	const double least = 0.06 * fmax(f->width, f->height), radius = fmin(fmax(f->radius, least), 0.46 * fmin(f->width, f->height)), margin = 1.05 * radius;
	const struct cast_frame frame = { .width = f->width, .height = f->height, .radius = radius, .x = fmin(fmax(f->x, margin), f->width - margin),
		.y = fmin(fmax(f->y, margin), f->height - margin), .turn = fmod(f->turn, 0.4), .left = f->mirrored };
	struct cast_truth truth;
	uint8_t *rgb = cast_render(&truth, &frame, rng);
	u->maker = UNSEEN_CAST;
	u->n = 1;
	u->aspect = NAN;
	u->warmth = truth.warmth;
	u->opening = truth.opening;
	u->eye[0] = (struct unseen_eye){ truth.limbus, truth.pupil, truth.showing, truth.theta };
	u->photo = unseen_photo(rgb, f->width, f->height);
	free(rgb);
	return true;
}
