/* deform_room: room to work in that poses of one rig have one after the other. A page, a .glb and hairs take hundreds of poses; what each of them
 * allocated and gave back the system would clear anew every time. */
#ifndef RIG_DEFORM_ROOM_H
#define RIG_DEFORM_ROOM_H

/* Where an edge crosses a column, mm, and how many faces more cover what is above than what is below (opening.c). */
struct deform_crossing {
	int column, change;
	double y;
};

/* How skin at a hair card's root has turned, and where its foot is, mm (cards.c). */
struct deform_motion {
	double turn[4], foot[3];
};

/* What is in it is nobody's between poses. Owned by deform_rooms. */
struct deform_room {
	double (*head)[3];                   // [rig.n] places about an eyeball's centre
	float *push, *gone, *most;           // [rig.n]
	int n, n_most;                       // crossings, and how many there is room for
	struct deform_crossing *crossing, *sorted; // [n_most]
	int *way;                            // [n_most] of faces
	int n_motions;
	struct deform_motion *motion;        // [n_motions]
	struct deform_room *next;
};

/* Rooms that rest, for a rig of n vertices: as many as were ever needed at a time. deform_rooms_free once all are back; null is accepted. */
struct deform_rooms;
struct deform_rooms *deform_rooms_new(int n);
void deform_rooms_free(struct deform_rooms *rooms);

/* Any thread may take one and give it back. */
struct deform_room *deform_room_take(struct deform_rooms *rooms);
void deform_room_give(struct deform_rooms *rooms, struct deform_room *room);

/* Makes place for n crossings, and n faces. */
void deform_room_hold(struct deform_room *room, int n);

/* Room for n motions. */
struct deform_motion *deform_room_motions(struct deform_room *room, int n);

#endif
