/* file: the bytes of a network's ONNX file.
 * It ends in a seal: an entry of ONNX's own metadata, "fnv1a64", whose value is the FNV-1a hash of all bytes before the entry. A cut or changed file fails it
 * before any of it is believed; tests/evidence/train.py writes it. The whole may be compressed (gzip).
 */
#ifndef NET_FILE_H
#define NET_FILE_H
#include <stddef.h>

#include "base/err.h"

/* *data: free(). False, err set (one line with the path), *data null, when the file is missing, damaged or without a seal. */
bool net_file_read(char **data, size_t *size, const char *path, struct err *err);

#endif
