#include "base/pack.h"

#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

static void put(struct pack *p, const void *data, size_t size)
{
	if (p->n + size > p->room) {
		p->room = p->n + size + p->room / 2 + 4096;
		p->bytes = mem_grow(p->bytes, p->room, 1);
	}
	memcpy(p->bytes + p->n, data, size);
	p->n += size;
}

void pack_bytes(struct pack *p, void *data, size_t size)
{
	if (!size)
		return;
	if (!p->reading) {
		put(p, data, size);
		return;
	}
	p->bad = p->bad || size > p->n - p->at;
	if (p->bad) {
		memset(data, 0, size);
		return;
	}
	memcpy(data, p->bytes + p->at, size);
	p->at += size;
}

void pack_free(struct pack *p)
{
	if (!p->reading)
		free(p->bytes);
	*p = (struct pack){ 0 };
}
