/* face: both eyes of a face in one photograph. They are of one size, lie side by side, and have pupils of one size: what one eye shows
 * clearly tells which of the ellipses tried in the other is the limbus, and where its pupil is.
 */
#ifndef LIMBUS_FACE_FACE_H
#define LIMBUS_FACE_FACE_H
#include "limbus/find.h"

enum { FACE_LEFT, FACE_RIGHT };  // the person's

/* Finds one eye as limbus_find does; where the evidence has another of like size at the distance that eyes have, that one as well.
 * found     overwritten; owns no memory
 * mirrored  the picture is a mirror image, or stands on its head: otherwise the person's left eye is the one farther right in it
 * Returns 1 where the photograph shows one eye: found[0] is what limbus_find says; 2 where it shows both: found[FACE_LEFT] and
 * found[FACE_RIGHT], each ok or refused alone. */
int limbus_find_face(struct limbus_found found[2], const struct photo *photo, bool mirrored, const struct limbus_conf *conf);

#endif
