/* other: pictures without an eye that look like one to a careless search. */
#ifndef EVIDENCE_OTHER_H
#define EVIDENCE_OTHER_H
#include "canvas.h"

enum other_kind { OTHER_NONE, OTHER_BALL, OTHER_WHEEL, OTHER_BUTTON, OTHER_TARGET, OTHER_TEXT, OTHER_TEXTURE, OTHER_DOLL, OTHER_CLUTTER, OTHER_FACE, OTHER_KINDS };

/* Draws one over the whole canvas; all of it is of the class of skin and background. Not for OTHER_NONE, OTHER_FACE. */
void other_draw(struct canvas *canvas, enum other_kind kind, struct rng *rng, bool test);

/* Shapes of all kinds, sizes and colours one over the other, sharp or soft, where `where` ([height][width]) is set; null: all over. */
void other_clutter(struct canvas *canvas, const bool *where, struct rng *rng, bool test);

#endif
