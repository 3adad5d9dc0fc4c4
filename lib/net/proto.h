/* proto: fields of a message in Google's protocol buffers' encoding, one after the other. Nothing is copied, and nothing beyond the message is read. */
#ifndef NET_PROTO_H
#define NET_PROTO_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Bytes of a message, of a string, or of an array. */
struct proto { const uint8_t *at, *end; };

struct proto_field {
	int number;
	uint64_t value;      // of a number; of a float its bits
	struct proto bytes;  // of what has a length; else empty
};

/* Takes the next field off p. False at the end, and, p->at null, where the message is damaged. */
bool proto_next(struct proto_field *field, struct proto *p);

/* The next number of an array that stands packed in bytes. False at the end, and, p->at null, where it is damaged. */
bool proto_number(uint64_t *value, struct proto *p);

size_t proto_size(struct proto bytes);

/* Whether two have the same bytes. */
bool proto_same(struct proto a, struct proto b);
bool proto_is(struct proto a, const char *text);

#endif
