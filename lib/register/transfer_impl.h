/* transfer_impl: what the parts of transfer share. */
#ifndef REGISTER_TRANSFER_IMPL_H
#define REGISTER_TRANSFER_IMPL_H
#include "register/transfer.h"

/* m x */
void transfer_place(double out[3], const double m[4][4], const float x[3]);

/* Row i of B: corners of that face of the subject. */
void transfer_row(struct transfer *out, int i, const struct mesh *subject, int face, const float bary[3]);

#endif
