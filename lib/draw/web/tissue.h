/* tissue: the fitted tissue for the interactive page. */
#ifndef DRAW_WEB_TISSUE_H
#define DRAW_WEB_TISSUE_H
#include <jansson.h>

#include "draw/web/source.h"

/* The tissue as fitted, with what each wavelength absorbs and scatters, and the intervals of one sigma that pigment.json states.
 * json_decref. */
json_t *web_tissue(const struct web_source *source);

#endif
