#include "render/film/film.h"

#include <stdlib.h>

#include "base/mem.h"

/* Whether the first n of the clip's records are there: a model may have come without the clip that it learnt from. */
static bool all_there(const struct skin_job *job, int n, const char *const in[n])
{
	for (int i = 0; i < n; i++)
		if (!file_exists(stage_path(job->stage, "%s", in[i])))
			return false;
	return true;
}

bool film_make(struct skin_job *job, struct err *err)
{
	static const char overlay[] = "work/render/track.mp4", course[] = "work/render/track.svg";
	struct file_list list;
	const char *in[] = { "work/skin/gaze.csv", "work/skin/track.json", "work/skin/lids.npy", "work/skin/skin.npy", "work/skin/confidence.npy", 0 };
	const int last = COUNT(in) - 1;
	if (!all_there(job, 2, in) || !stage_list(job->stage, &list, "video", err))
		return !err_is(err);
	char *video = list.n ? mem_printf("video/%s", list.names[0]) : 0;
	in[last] = video;
	file_list_free(&list);
	bool ok = file_mkdirs(stage_path(job->stage, "work/render"), err);
	if (ok && !skin_kept(job, course, 2, in, err))
		ok = film_course(job, course, 2, in, err) && skin_made(job, course, 2, in, err);
	if (ok && video && job->conf->clip_px > 0 && all_there(job, last, in) && !skin_kept(job, overlay, COUNT(in), in, err))
		ok = film_overlay(job, overlay, COUNT(in), in, err) && skin_made(job, overlay, COUNT(in), in, err);
	free(video);
	return ok;
}
