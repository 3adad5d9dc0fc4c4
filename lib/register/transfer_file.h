/* transfer_file: what `transfer` leaves for `extrapolate` and for other programs. */
#ifndef REGISTER_TRANSFER_FILE_H
#define REGISTER_TRANSFER_FILE_H
#include "register/transfer.h"

/* B as compressed rows (SciPy's csr): indptr, indices int32, data float32, shape int64 [2]; and face int32, bary float32
 * [n][3], distance_mm, confidence float32. made_by: JSON text or null. */
bool transfer_save_matrix(const struct transfer *transfer, int subject_vertices, const char *path, const char *made_by, struct err *err);

#endif
