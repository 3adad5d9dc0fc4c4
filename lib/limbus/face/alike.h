/* alike: what the two eyes of a face tell of each other. Internal to limbus_find_face.
 */
#ifndef LIMBUS_FACE_ALIKE_H
#define LIMBUS_FACE_ALIKE_H
#include "limbus/trial.h"


/* Adds to the log odds of each eye's trials what the other's, each by its own odds, say of its size. */
void face_alike_odds(struct trials *one, struct trials *other, const struct face_conf *conf);

/* Refuses the less sure of two limbi whose sizes no face has together. */
void face_alike_sizes(struct limbus_found found[2], const struct face_conf *conf);

/* Where one pupil is known, looks for one like it in the other eye; of two that are too unlike the less clear one goes. */
void face_alike_pupils(struct limbus_found found[2], const struct photo *photo, const struct limbus_conf *conf);

#endif
