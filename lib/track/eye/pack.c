/* What is kept of every frame: its room, and the state on the way through a clip as bytes. */
#include "track/eye/eye_track_impl.h"

void eye_side_room(struct eye_side *eye, long frames, long edges)
{
	struct bulk *bulk = eye->scene->bulk;
	if (frames > eye->space) {
		const long more = eye->space + eye->space / 4 + 256;
		eye->space = more > frames ? more : frames;
		eye->state = bulk_grow(bulk, eye->state, (size_t)eye->space, sizeof *eye->state);
		eye->record = bulk_grow(bulk, eye->record, (size_t)eye->space, sizeof *eye->record);
		eye->kept = bulk_grow(bulk, eye->kept, (size_t)eye->space, sizeof *eye->kept);
		eye->fine = bulk_grow(bulk, eye->fine, (size_t)eye->space, sizeof *eye->fine);
	}
	if (edges > eye->edge_space) {
		eye->edge_space = edges + edges / 4 + 1000;
		eye->edge = bulk_grow(bulk, eye->edge, (size_t)eye->edge_space, sizeof *eye->edge);
	}
}

void eye_side_pack(struct pack *p, struct eye_side *eye, long first)
{
	long frames = eye->frames, edges = eye->edges;
	const long known = eye->edges_packed;
	PACK(p, frames);
	PACK(p, edges);
	if (p->reading) {
		p->bad = p->bad || frames < first || edges < known || eye->frames != first || (size_t)(frames - first) > p->n || (size_t)(edges - known) > p->n;
		if (p->bad)
			return;
		eye_side_room(eye, frames, edges);
	}
	const size_t more = (size_t)(frames - first);
	if (more) {
		pack_bytes(p, eye->state + first, more * sizeof *eye->state);
		pack_bytes(p, eye->record + first, more * sizeof *eye->record);
		pack_bytes(p, eye->kept + first, more * sizeof *eye->kept);
		pack_bytes(p, eye->fine + first, more * sizeof *eye->fine);
	}
	if (edges > known)
		pack_bytes(p, eye->edge + known, (size_t)(edges - known) * sizeof *eye->edge);
	eye->frames = frames;
	eye->edges = eye->edges_packed = edges;
	PACK(p, eye->absent);
	PACK(p, eye->started);
	PACK(p, eye->globe);
	PACK(p, eye->canthus);
	PACK(p, eye->corners_guessed);
	PACK(p, eye->fick);
	PACK(p, eye->have);
	PACK(p, eye->lost_s);
	PACK(p, eye->denied_s);
	PACK(p, eye->contrast);
	PACK(p, eye->lids);
	PACK(p, eye->torsion);
	PACK(p, eye->still);
	PACK(p, eye->last);
}
