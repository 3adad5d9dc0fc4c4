/* film: what was tracked in the person's video, for people to look at: the video with gaze, lids and skin drawn on it, and their course over time.
 */
#ifndef RENDER_FILM_FILM_H
#define RENDER_FILM_FILM_H
#include "render/face/skin.h"

/* Makes work/render/track.mp4 (job->conf->clip_px wide; 0: none) and work/skin's course work/render/track.svg where they are not fresh. A folder
 * without a followed video is no error. Returns false, err set, when a file cannot be read or written. */
bool film_make(struct skin_job *job, struct err *err);

/* overlay.c, course.c. rel: the file, relative to the folder; n, in: its inputs. */
bool film_overlay(struct skin_job *job, const char *rel, int n, const char *const in[], struct err *err);
bool film_course(struct skin_job *job, const char *rel, int n, const char *const in[], struct err *err);

#endif
