/* hand: the limbus where a person says it is (photo.NAME.hint_px, photo.NAME.limbus_px). It is an order: an ellipse near that place is
 * always returned, with a standard deviation that says how well it is known.
 */
#ifndef LIMBUS_HAND_H
#define LIMBUS_HAND_H
#include "limbus/find.h"

/* Checks a hint (x, y, radius px) or a drawn ellipse against a photograph: the centre lies in it, the semi-axes are at least 8 px and at
 * most the photograph's longer side, a >= b. key: "photo.NAME.hint_px". False, err set (key, value, rule), where it cannot be meant. */
bool limbus_hand_check(const struct ellipse *e, const char *key, int width, int height, struct err *err);

/* Checks two such places against each other: of one eye they are near each other (limbus_hand_near), of a face's two eyes the centres
 * are further apart than the larger semi-axis. False, err set (both keys, rule), where they cannot both be meant. */
bool limbus_hand_agree(const struct ellipse *a, const char *key_a, const struct ellipse *b, const char *key_b, bool same_eye, struct err *err);

/* Whether an ellipse is the one that is meant: its centre within a third of the radius, its size within a third. */
bool limbus_hand_near(const struct ellipse *e, const struct ellipse *meant);

/* Fills found->limbus by an edge fit round the ellipse that is meant, where one stays near it, else with that ellipse itself; sets
 * found->ok and found->by_hand.
 * sigma  of the hand, share of the semi-axis. Of an edge fit sigmas are at least half of how far it is off the hand's ellipse. */
void limbus_by_hand(struct limbus_found *found, const struct photo *photo, const struct pyramid *pyramid, const struct ellipse *meant,
                    double sigma, const struct limbus_conf *conf);

#endif
