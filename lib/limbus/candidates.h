/* candidates: places of irises in planes of evidence. */
#ifndef LIMBUS_CANDIDATES_H
#define LIMBUS_CANDIDATES_H
#include "limbus/evidence.h"

enum { CANDIDATES_MAX = 12 };

/* The candidates in planes, best first; returns how many. */
int candidates_of(struct evidence_region out[CANDIDATES_MAX], const struct evidence *evidence);

/* Places that may be irises of 2 to 8 px radius in the network's input, whatever dark lies beside them: squares with more evidence of iris
 * and pupil than a square of thrice their size round them. Their score is that difference. */
int candidates_spots(struct evidence_region out[CANDIDATES_MAX], const struct evidence *evidence);

/* Candidates of one scale among those of others, of which there are n: of two at one place the better stays; where they agree on the
 * radius, too, it gains what the other says. Returns how many there are now. */
int candidates_merge(struct evidence_region out[CANDIDATES_MAX], int n, const struct evidence_region *more, int m);

#endif
