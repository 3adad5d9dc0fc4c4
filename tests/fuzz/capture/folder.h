/* folder: a whole capture in memory, as bytes that a fuzzer may cut up: one entry behind the other, "KIND NAME SIZE\n" and SIZE bytes.
 *   @  a file      /  a folder      |  a pipe      ~  a file of holes, its length written out in the bytes
 */
#ifndef TESTS_FUZZ_CAPTURE_FOLDER_H
#define TESTS_FUZZ_CAPTURE_FOLDER_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { FOLDER_MOST = 64, FOLDER_NAME = 200 };

struct folder_entry {
	char kind, name[FOLDER_NAME];
	const uint8_t *data;  // within what was parsed
	size_t size;
};

struct folder {
	int n;
	struct folder_entry entries[FOLDER_MOST];
};

/* The entries up to the first that is none. Names lead nowhere outside. */
void folder_parse(struct folder *f, const uint8_t *data, size_t size);
/* The bytes of all entries; returns how many, 0 where they do not fit into `most`. */
size_t folder_pack(uint8_t *out, size_t most, const struct folder *f);
/* Makes it on disk, in an empty folder; what cannot be made is left out. */
void folder_unpack(const struct folder *f, const char *dir);
/* Removes all that is in `dir`. */
void folder_empty(const char *dir);

#endif
