#include "register/transfer_file.h"

#include <stdlib.h>

#include "base/mem.h"
#include "base/npy/npy.h"

bool transfer_save_matrix(const struct transfer *t, int subject_vertices, const char *path, const char *made_by, struct err *err)
{
	size_t n = (size_t)t->n;
	int32_t *indptr = mem_array(n + 1, sizeof *indptr), *indices = mem_array(3 * n + 1, sizeof *indices), at = 0;
	float *data = mem_array(3 * n + 1, sizeof *data);
	indptr[0] = 0;
	for (int i = 0; i < t->n; i++) {
		for (int k = 0; k < 3; k++)
			if (t->weight[i][k] > 0) {
				indices[at] = t->column[i][k];
				data[at++] = (float)t->weight[i][k];
			}
		indptr[i + 1] = at;
	}
	int64_t shape[2] = { t->n, subject_vertices };
	const struct npz_item items[] = {
		{ "indptr", npy_of(NPY_I4, 1, (long[]){ t->n + 1 }, indptr) },
		{ "indices", npy_of(NPY_I4, 1, (long[]){ at }, indices) },
		{ "data", npy_of(NPY_F4, 1, (long[]){ at }, data) },
		{ "shape", npy_of(NPY_I8, 1, (long[]){ 2 }, shape) },
		{ "face", npy_of(NPY_I4, 1, (long[]){ t->n }, t->face) },
		{ "bary", npy_of(NPY_F4, 2, (long[]){ t->n, 3 }, t->bary) },
		{ "distance_mm", npy_of(NPY_F4, 1, (long[]){ t->n }, t->distance) },
		{ "confidence", npy_of(NPY_F4, 1, (long[]){ t->n }, t->confidence) },
	};
	bool ok = npz_save(path, COUNT(items), items, made_by, err);
	free(indptr);
	free(indices);
	free(data);
	return ok;
}
