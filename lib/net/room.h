/* room: memory in which one picture at a time goes through a network: pieces that are used again as soon as nothing reads them any more, so that most of it
 * stays in the processor's caches, and again by the next picture. */
#ifndef NET_ROOM_H
#define NET_ROOM_H
#include <stdbool.h>
#include <stddef.h>

struct net_room_piece { float *floats; size_t n; bool taken; };

struct net_room {
	struct net_room_piece *piece;
	int n;
};

/* A piece of at least n floats, aligned to 64 bytes, not set; free again from net_room_leave on. Its number. */
int net_room_take(struct net_room *room, size_t n);
void net_room_leave(struct net_room *room, int piece);

/* Gives all back; net_room may be zero. */
void net_room_free(struct net_room *room);

#endif
