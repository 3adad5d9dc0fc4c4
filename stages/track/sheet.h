/* sheet: the contact sheet of a clip, for people to look at. */
#ifndef STAGES_TRACK_SHEET_H
#define STAGES_TRACK_SHEET_H
#include "track/clip/film.h"
#include "track/clip/result.h"

/* Writes a PNG of frames of film: the reference, blinks, peaks of expressions, the furthest gazes, others between; with
 * margins, limbus and points drawn. Returns false, err set, when it cannot be written. */
bool track_sheet(const struct film *film, const char *path, const struct track_result *result, const struct track_clip *clip,
                 const struct track_conf *conf, struct err *err);

#endif
