/* transfer_quality: how well a registered target lies on the subject. */
#ifndef REGISTER_TRANSFER_QUALITY_H
#define REGISTER_TRANSFER_QUALITY_H
#include "register/transfer.h"

#define TRANSFER_TRUSTED 0.2f  // confidence above which a vertex counts as registered

/* How many vertices follow the subject: those with a confidence above TRANSFER_TRUSTED. */
int transfer_trusted(const struct transfer *transfer);

/* Quantile q (0..1) of the distance from the subject over those vertices, mm. */
double transfer_distance(const struct transfer *transfer, double q);

#endif
