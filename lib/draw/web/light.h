/* light: an environment for the interactive page. */
#ifndef DRAW_WEB_LIGHT_H
#define DRAW_WEB_LIGHT_H
#include <jansson.h>

#include "draw/web/source.h"

/* {name, beams, lights, skies, quadric, wet} and, where the cornea mirrors it, {sharp, rough}: its beams and directions, those
 * that the skin mirrors, its irradiance as a quadric of the normal, that below a film (envmap_wet), its two maps for reflections.
 * mirror  what the cornea mirrors; null: nothing
 * source  beams, and directions in each
 * json_decref. */
json_t *web_light(const char *name, const struct envmap *env, const struct envmap *mirror, const struct web_source *source, struct err *err);

#endif
