#include "net/room.h"

#include <stdlib.h>

#include "base/mem.h"

/* The smallest that is large enough; else the largest, which grows; -1: all are taken. */
static int best(const struct net_room *room, size_t n)
{
	int at = -1;
	for (int i = 0; i < room->n; i++) {
		const struct net_room_piece *p = &room->piece[i], *b = at >= 0 ? &room->piece[at] : 0;
		if (!p->taken && (!b || (b->n < n ? p->n > b->n : p->n >= n && p->n < b->n)))
			at = i;
	}
	return at;
}

int net_room_take(struct net_room *room, size_t n)
{
	int at = best(room, n);
	if (at < 0) {
		at = room->n++;
		room->piece = mem_grow(room->piece, (size_t)room->n, sizeof *room->piece);
		room->piece[at] = (struct net_room_piece){ 0 };
	}
	struct net_room_piece *p = &room->piece[at];
	if (p->n < n) {
		free(p->floats);
		*p = (struct net_room_piece){ .floats = mem_array(n, sizeof *p->floats), .n = n };
	}
	p->taken = true;
	return at;
}

void net_room_leave(struct net_room *room, int piece)
{
	room->piece[piece].taken = false;
}

void net_room_free(struct net_room *room)
{
	for (int i = 0; i < room->n; i++)
		free(room->piece[i].floats);
	free(room->piece);
	*room = (struct net_room){ 0 };
}
