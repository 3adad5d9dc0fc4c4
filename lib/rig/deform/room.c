#include "rig/deform/room.h"

#include <pthread.h>
#include <stdlib.h>

#include "base/mem.h"

struct deform_rooms {
	int n;
	pthread_mutex_t lock;
	struct deform_room *rests;
};

struct deform_rooms *deform_rooms_new(int n)
{
	struct deform_rooms *rooms = mem_new(1, sizeof *rooms);
	rooms->n = n;
	pthread_mutex_init(&rooms->lock, 0);
	return rooms;
}

void deform_rooms_free(struct deform_rooms *rooms)
{
	if (!rooms)
		return;
	while (rooms->rests) {
		struct deform_room *room = rooms->rests;
		rooms->rests = room->next;
		free(room->head);
		free(room->push);
		free(room->crossing);
		free(room->sorted);
		free(room->way);
		free(room->gone);
		free(room->most);
		free(room->motion);
		free(room);
	}
	pthread_mutex_destroy(&rooms->lock);
	free(rooms);
}

struct deform_room *deform_room_take(struct deform_rooms *rooms)
{
	pthread_mutex_lock(&rooms->lock);
	struct deform_room *room = rooms->rests;
	if (room)
		rooms->rests = room->next;
	pthread_mutex_unlock(&rooms->lock);
	if (!room) {
		room = mem_new(1, sizeof *room);
		room->head = mem_array((size_t)rooms->n + 1, sizeof *room->head);
		room->push = mem_array((size_t)rooms->n + 1, sizeof *room->push);
		room->gone = mem_array((size_t)rooms->n + 1, sizeof *room->gone);
		room->most = mem_array((size_t)rooms->n + 1, sizeof *room->most);
	}
	room->n = 0;
	return room;
}

void deform_room_give(struct deform_rooms *rooms, struct deform_room *room)
{
	pthread_mutex_lock(&rooms->lock);
	room->next = rooms->rests;
	rooms->rests = room;
	pthread_mutex_unlock(&rooms->lock);
}

void deform_room_hold(struct deform_room *room, int n)
{
	if (n <= room->n_most)
		return;
	room->n_most = n + room->n_most + 1024;
	room->crossing = mem_grow(room->crossing, (size_t)room->n_most, sizeof *room->crossing);
	room->sorted = mem_grow(room->sorted, (size_t)room->n_most, sizeof *room->sorted);
	room->way = mem_grow(room->way, (size_t)room->n_most, sizeof *room->way);
}

struct deform_motion *deform_room_motions(struct deform_room *room, int n)
{
	if (n > room->n_motions)
		room->motion = mem_grow(room->motion, (size_t)(room->n_motions = n), sizeof *room->motion);
	return room->motion;
}
