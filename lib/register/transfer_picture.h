/* transfer_picture: a picture of a registration, in three panels: the subject; the registered target, coloured by its distance from
 * the subject; both in one.
 */
#ifndef REGISTER_TRANSFER_PICTURE_H
#define REGISTER_TRANSFER_PICTURE_H
#include "register/transfer.h"

/* Draws the panels from the front (along -z of the subject's axes), orthographic, and writes an 8-bit sRGB PNG.
 * target  its faces are drawn, at the registered places
 * Returns false, err set, when it cannot be written. */
bool transfer_save_picture(const struct transfer *transfer, const struct mesh *target, const struct mesh *subject, const char *path,
                           struct err *err);

#endif
