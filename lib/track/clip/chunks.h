/* chunks: what has been followed of a long clip so far, kept on disk (work/skin/followed-NNNN.part, each written beside and renamed), so that a run that was killed
 * goes on from its last whole chunk with the very state it had there: the result has the same bytes.
 * A chunk counts only under the key of its clip: program, inputs, settings, the reference's pose, and the inode and time of change of a file that this machine made:
 * the state is taken as it stands, and one that came with a stranger's folder is none of ours.
 */
#ifndef TRACK_CLIP_CHUNKS_H
#define TRACK_CLIP_CHUNKS_H
#include "track/clip/clip.h"
#include "track/clip/follow_impl.h"

struct chunks {
	struct stage *stage;
	char key[33];
	int n;                 // on disk
	long every, first;     // frames of one; the next one's first. every 0: none are kept
};

/* Whether a clip is to be followed whole and is longer than a chunk: what grows with it lies on the disk then. */
bool chunks_wanted(const struct track_clip *clip, const struct track_conf *conf);

/* Of other clips none are kept. */
struct chunks chunks_of(struct stage *stage, const struct track_clip *clip, const struct track_points *points, const struct track_conf *conf);

/* Reads what is there. Returns false where a chunk is not what it should be: follow is not to be used then, and the chunks are gone. */
bool chunks_read(struct chunks *chunks, struct follow *follow);

/* Writes a chunk when it is full. A disk without room is told of, and no more are kept. */
void chunks_keep(struct chunks *chunks, struct follow *follow);

/* Removes all there are. */
void chunks_remove(struct stage *stage);

#endif
