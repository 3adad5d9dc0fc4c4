/* lids: what lids left of the light on the iris in a photograph (iris/unrefract/shade.h), taken from its texture and given to its own picture again. */
#ifndef DRAW_PHOTO_LIDS_H
#define DRAW_PHOTO_LIDS_H
#include <jansson.h>

#include "anatomy/eye.h"
#include "draw/photo/photo.h"

/* Reads it from the photograph's entry in texture.json: shot->lids. True also where there is none. False, err set (texture_json, key, rule). */
bool shot_lids_read(struct shot *shot, const json_t *entry, const char *texture_json, struct err *err);

/* Multiplies the colours of the iris in a picture of shot_view(shot) by it. */
void shot_lids(struct image *rgba, const struct shot *shot, const struct eye *eye);

#endif
