/* pack: a state as bytes and back, by one function for both directions: it names every part once, and each is written or read.
 * Bytes are this machine's own, of this very program: for a run that goes on where it was killed, not for exchange.
 *
 *     struct pack p = { .reading = false };
 *     state_pack(&p, &state);        // p.bytes, p.n; pack_free
 */
#ifndef BASE_PACK_H
#define BASE_PACK_H
#include <stdbool.h>
#include <stddef.h>

struct pack {
	bool reading;          // from bytes[n], which are the caller's; else they are written, and owned
	bool bad;              // more was read than there is, or a part found what it read impossible: the state is not to be used
	char *bytes;
	size_t n, room, at;    // written or there to be read; allocated; read so far
};

/* Writes `size` bytes of data, or reads them into it; zeroed where there are none left. */
void pack_bytes(struct pack *pack, void *data, size_t size);

/* One object. */
#define PACK(pack, x) pack_bytes(pack, &(x), sizeof(x))

void pack_free(struct pack *pack);

#endif
