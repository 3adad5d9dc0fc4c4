#include "render/film/film.h"

#include <stdlib.h>

#include "base/mem.h"

bool film_make(struct skin_job *job, struct err *err)
{
	static const char overlay[] = "work/render/track.mp4", course[] = "work/render/track.svg";
	struct file_list list;
	if (!file_exists(stage_path(job->stage, "work/skin/gaze.csv")) || !stage_list(job->stage, &list, "video", err))
		return !err_is(err);
	char *video = list.n ? mem_printf("video/%s", list.names[0]) : 0;
	const char *in[] = { "work/skin/gaze.csv", "work/skin/track.json", "work/skin/lids.npy", "work/skin/skin.npy", "work/skin/confidence.npy", video };
	file_list_free(&list);
	bool ok = file_mkdirs(stage_path(job->stage, "work/render"), err);
	if (ok && !skin_kept(job, course, 2, in, err))
		ok = film_course(job, course, 2, in, err) && skin_made(job, course, 2, in, err);
	if (ok && video && job->conf->clip_px > 0 && !skin_kept(job, overlay, COUNT(in), in, err))
		ok = film_overlay(job, overlay, COUNT(in), in, err) && skin_made(job, overlay, COUNT(in), in, err);
	free(video);
	return ok;
}
