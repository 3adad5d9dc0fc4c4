/* viewer: work/review/viewer.html, the page on which a fitted eye is turned, lit and changed live. It draws the same model as
 * draw/eye/scene.h, by WebGL 2 shaders (render/viewer); its numbers and maps are those of the C renderer (draw/web). */
#ifndef RENDER_VIEWER_VIEWER_H
#define RENDER_VIEWER_VIEWER_H
#include "render/face/skin.h"

/* Writes the page where it is not fresh: the photographed eyes, and the first character that has a rig, whose eyes are plain
 * ones where none was photographed. Neither: no page. */
bool viewer_make(struct skin_job *skin, struct err *err);

#endif
