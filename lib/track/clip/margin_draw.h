/* margin_draw: corners and margins of the lids drawn to what is seen of them in some frames, each by how well it is known. */
#ifndef TRACK_CLIP_MARGIN_DRAW_H
#define TRACK_CLIP_MARGIN_DRAW_H
#include "track/clip/margin_seen.h"

/* seen: of each frame whose number conf's lids.every divides, [frame / every]; fps: of the frames that were followed. */
void margin_draw(struct track_result *result, const struct margin_seen (*seen)[SIDES], double fps, const struct track_conf *conf);

#endif
