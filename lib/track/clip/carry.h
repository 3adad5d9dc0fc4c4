/* carry: how far a face has moved from one frame to the next. What lies round both eyes is compared in a few hundred large pixels: through blinks and winks, and through nods that are faster
 * than a window round an iris is wide.
 */
#ifndef TRACK_CLIP_CARRY_H
#define TRACK_CLIP_CARRY_H
#include <stdbool.h>
#include <stdint.h>

enum { CARRY_WIDE = 40, CARRY_HIGH = 28 };

/* What lay round the eyes in the last frame. All 0: nothing yet. */
struct carry {
	bool known;
	double apart;                              // px between the eyes
	double middle[2];                          // between them, px
	float patch[CARRY_HIGH][CARRY_WIDE];       // NAN: outside of the picture
};

/* Keeps a frame in which the middle between the eyes lies there, and these so far apart. px */
void carry_keep(struct carry *carry, const uint8_t *luma, int stride, int width, int height, const double middle[2], double apart);

/* shift: from the frame kept to this one, px. Returns false where nothing like it is seen within an eyes' distance or so. */
bool carry_find(double shift[2], const struct carry *carry, const uint8_t *luma, int stride, int width, int height);

#endif
