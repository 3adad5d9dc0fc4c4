#include "net/file.h"

#include <inttypes.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include "base/file.h"
#include "base/mem.h"

static const size_t MOST = 64 << 20;
/* ModelProto field 14 (metadata_props) of 27 bytes: key (7 bytes), value (16 bytes). */
static const char SEAL[] = "\x72\x1b\x0a\x07" "fnv1a64" "\x12\x10";
enum { HEAD = sizeof SEAL - 1, DIGITS = 16, SEALED = HEAD + DIGITS };

/* Fowler, Noll and Vo, 64 bits. */
static uint64_t fnv1a(const char *data, size_t n)
{
	uint64_t hash = 0xcbf29ce484222325;
	for (size_t i = 0; i < n; i++)
		hash = (hash ^ (unsigned char)data[i]) * 0x100000001b3;
	return hash;
}

static bool is_sealed(const char *data, size_t size)
{
	if (size <= SEALED || memcmp(data + size - SEALED, SEAL, HEAD) != 0)
		return false;
	char value[DIGITS + 1];
	snprintf(value, sizeof value, "%016" PRIx64, fnv1a(data, size - SEALED));
	return memcmp(value, data + size - DIGITS, DIGITS) == 0;
}

/* What a gzip file holds; free(). Null: it is none, damaged, with something behind it, or longer than MOST. */
static char *expanded(size_t *size, const char *data, size_t n)
{
	enum { GZIP = 16, PIECE = 1 << 20 };  // GZIP: zlib's sign for gzip's header and trailer
	z_stream z = { .next_in = (Bytef *)data, .avail_in = (uInt)n };
	if (n < 18 || memcmp(data, "\x1f\x8b", 2) != 0 || inflateInit2(&z, MAX_WBITS + GZIP) != Z_OK)
		return 0;
	char *out = 0;
	int state = Z_OK;
	*size = 0;
	while (state == Z_OK && *size < MOST) {
		out = mem_grow(out, *size + PIECE, 1);
		z.next_out = (Bytef *)out + *size;
		z.avail_out = PIECE;
		state = inflate(&z, Z_NO_FLUSH);
		*size += PIECE - z.avail_out;
	}
	inflateEnd(&z);
	if (state == Z_STREAM_END && z.avail_in == 0)
		return out;
	free(out);
	return 0;
}

bool net_file_read(char **data, size_t *size, const char *path, struct err *err)
{
	if (!file_read(data, size, path, MOST, err)) {
		*data = 0;
		return false;
	}
	size_t n;
	char *plain = expanded(&n, *data, *size);
	if (plain) {
		free(*data);
		*data = plain;
		*size = n;
	}
	if (is_sealed(*data, *size))
		return true;
	free(*data);
	*data = 0;
	return err_set(err, "%s: damaged, or no network of this program: its bytes do not fit its seal", path);
}
