/* .npy and .npz files, whole and row by row. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "base/npy/npy.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct err err[3] = { 0 };
	struct npy array, head;
	const char *path = fuzz_file(data, size);
	if (npy_read(&array, path, 1 << 20, &err[0]))
		free(npy_doubles(&array));
	npy_free(&array);
	struct npy_rows *rows = npy_rows_open(&head, path, &err[1]);
	long n = 1, row = rows && head.shape[0] ? npy_count(&head) / head.shape[0] : 0;
	double *block = malloc(4 * (size_t)row * sizeof *block + 1);
	for (int i = 0; rows && i < 9 && n; i++)
		if (!npy_rows_next(rows, 4, block, &n, &err[1]))
			break;
	npy_rows_close(rows);
	free(block);
	if (npz_read(&array, path, "x", 1 << 20, &err[2]))
		free(npy_doubles(&array));
	npy_free(&array);
	for (int i = 0; i < 3; i++)
		if (strchr(err[i].msg, '\n'))
			abort();
	return 0;
}
