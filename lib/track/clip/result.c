#include "track/clip/result.h"

#include <stdlib.h>

#include "base/mem.h"
#include "track/clip/film.h"
#include "track/clip/folds.h"

void track_result_room(struct track_result *r, long *room, long frames)
{
	if (frames <= *room)
		return;
	const long more = *room + *room / 4 + 256;
	*room = more > frames ? more : frames;
	size_t n = (size_t)*room, m = n * (size_t)r->n_points;
	r->time = mem_grow(r->time, n, sizeof *r->time);
	r->lost_at = mem_grow(r->lost_at, n, sizeof *r->lost_at);
	r->pose = mem_grow(r->pose, n, sizeof *r->pose);
	r->skin = bulk_grow(r->bulk, r->skin, m + 1, sizeof *r->skin);
	r->skin_model = bulk_grow(r->bulk, r->skin_model, m + 1, sizeof *r->skin_model);
	r->confidence = bulk_grow(r->bulk, r->confidence, m + 1, sizeof *r->confidence);
}

void track_result_free(struct track_result *r)
{
	free(r->time);
	free(r->lost_at);
	free(r->unsure_at);
	free(r->pose);
	bulk_free(r->bulk, r->skin);
	bulk_free(r->bulk, r->skin_model);
	bulk_free(r->bulk, r->confidence);
	bulk_free(r->bulk, r->lids);
	bulk_free(r->bulk, r->lids_model);
	free(r->g);
	free(r->aperture_sigma);
	free(r->misfit);
	eye_clip_free(&r->eyes);
	film_free(r->film);
	folds_free(r->folds);
	bulk_close(r->bulk);
}
