/* transfer_picture: what a registration looks like: the subject, the character laid onto it with its distances as colours, and
 * one in the other.
 */
#ifndef REGISTER_TRANSFER_PICTURE_H
#define REGISTER_TRANSFER_PICTURE_H
#include "register/transfer.h"

/* From the front (along -z of the subject's axes), orthographic; target: for its faces. PNG, 8-bit sRGB. */
bool transfer_save_picture(const struct transfer *transfer, const struct mesh *target, const struct mesh *subject, const char *path,
                           struct err *err);

#endif
