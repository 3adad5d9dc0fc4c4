#include "net/proto.h"

#include <string.h>

enum { NUMBER, EIGHT_BYTES, BYTES, FOUR_BYTES = 5 };

size_t proto_size(struct proto bytes)
{
	return (size_t)(bytes.end - bytes.at);
}

bool proto_same(struct proto a, struct proto b)
{
	return proto_size(a) == proto_size(b) && (a.at == a.end || memcmp(a.at, b.at, proto_size(a)) == 0);
}

bool proto_is(struct proto a, const char *text)
{
	return proto_same(a, (struct proto){ (const uint8_t *)text, (const uint8_t *)text + strlen(text) });
}

static bool damaged(struct proto *p)
{
	*p = (struct proto){ 0 };
	return false;
}

bool proto_number(uint64_t *value, struct proto *p)
{
	*value = 0;
	if (p->at == p->end)
		return false;
	for (int shift = 0; shift < 64 && p->at < p->end; shift += 7) {
		const uint8_t byte = *p->at++;
		*value |= (uint64_t)(byte & 127) << shift;
		if (byte < 128)
			return true;
	}
	return damaged(p);
}

/* So many bytes off p. */
static bool take(struct proto *bytes, struct proto *p, uint64_t n)
{
	if (n > proto_size(*p))
		return damaged(p);
	*bytes = (struct proto){ p->at, p->at + n };
	p->at += n;
	return true;
}

bool proto_next(struct proto_field *field, struct proto *p)
{
	static const uint8_t none[1];
	uint64_t key, n;
	struct proto raw;
	*field = (struct proto_field){ .bytes = { none, none } };
	if (!proto_number(&key, p))
		return false;
	if (key >> 3 > 1 << 16)
		return damaged(p);
	field->number = (int)(key >> 3);
	switch (key & 7) {
	case NUMBER: return proto_number(&field->value, p) || damaged(p);
	case BYTES: return proto_number(&n, p) ? take(&field->bytes, p, n) : damaged(p);
	case EIGHT_BYTES:
	case FOUR_BYTES:
		if (!take(&raw, p, (key & 7) == EIGHT_BYTES ? 8 : 4))
			return false;
		memcpy(&field->value, raw.at, proto_size(raw));  // little-endian, as all that Debian builds this for
		return true;
	default: return damaged(p);
	}
}
