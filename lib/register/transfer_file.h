/* transfer_file: writes the barycentric matrix B of a registration. */
#ifndef REGISTER_TRANSFER_FILE_H
#define REGISTER_TRANSFER_FILE_H
#include "register/transfer.h"

/* Writes a .npz with B as compressed rows (SciPy's csr): indptr, indices int32, data float32, shape int64 [2]; and face int32, bary
 * float32 [n][3], distance_mm, confidence float32 [n].
 * subject_vertices  columns of B
 * made_by           JSON text or null
 * Returns false, err set, when it cannot be written. */
bool transfer_save_matrix(const struct transfer *transfer, int subject_vertices, const char *path, const char *made_by, struct err *err);

#endif
