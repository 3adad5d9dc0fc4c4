/* eye: a scene of the C renderer as numbers, maps and lights for the interactive page. */
#ifndef DRAW_WEB_EYE_H
#define DRAW_WEB_EYE_H
#include <jansson.h>

#include "draw/web/source.h"

/* Everything the page needs of one eye. Null, err set, when a map cannot be encoded. json_decref. */
json_t *web_eye(const struct web_source *source, struct err *err);

#endif
