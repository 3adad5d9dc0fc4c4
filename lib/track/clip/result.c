#include "track/clip/result.h"

#include <stdlib.h>

#include "track/clip/film.h"
#include "track/clip/folds.h"

void track_result_free(struct track_result *r)
{
	free(r->time);
	free(r->lost_at);
	free(r->unsure_at);
	free(r->pose);
	free(r->skin);
	free(r->skin_model);
	free(r->confidence);
	free(r->lids);
	free(r->lids_model);
	free(r->g);
	free(r->aperture_sigma);
	free(r->misfit);
	eye_clip_free(&r->eyes);
	film_free(r->film);
	folds_free(r->folds);
}
