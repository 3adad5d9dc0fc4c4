/* wrinkle: wrinkle lines of capture.conf's expressions: the frames they are seen in, kept while the clip is followed. */
#ifndef TRACK_CLIP_FOLDS_H
#define TRACK_CLIP_FOLDS_H
#include "track/clip/track.h"

enum { WRINKLE_FILES = 3 };
extern const char *const wrinkle_files[WRINKLE_FILES];  // relative to the capture; made where wrinkles_wanted

/* There are expressions, and a mesh to find their skin on. */
bool wrinkles_wanted(const struct track_conf *conf, bool has_mesh);

struct folds;
struct folds *folds_new(const struct track_clip *clip, const struct track_points *points, const struct track_conf *conf);
void folds_add(struct folds *folds, const struct video_frame *frame);
void folds_free(struct folds *folds);

/* Finds them and writes their files; says what was not found, and why. in: what stage_made wants. */
bool folds_finish(struct folds *folds, struct stage *stage, const struct track_result *result, const struct track_clip *clip,
                  const struct track_subject *subject, const struct track_points *points, const struct track_conf *conf, int n,
                  const char *const in[], struct err *err);

/* folds_sheet.c: each expression's neutral frame, its peak with the lines drawn, and its bump map. */
bool wrinkle_sheet(const char *path, const struct wrinkles *w, const struct wrinkle_ground *ground, int n,
                   const struct wrinkle_frame neutral[], const struct wrinkle_frame peak[], struct err *err);

#endif
