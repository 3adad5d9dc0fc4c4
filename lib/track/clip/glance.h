/* glance: what a network makes of the pixels round both eyes in each frame (limbus/evidence.h), where irises are too small for edges and colours to tell them, or there is no mesh.
 * Image  px, centre of the first pixel (0.5, 0.5).
 */
#ifndef TRACK_CLIP_GLANCE_H
#define TRACK_CLIP_GLANCE_H
#include "track/clip/clip.h"
#include "track/clip/conf.h"
#include "track/eye/told.h"

struct glance;

/* Null where it is not asked for (conf's evidence_px), or the network cannot be opened, which the search for the reference reports. clip and subject are borrowed until
 * glance_free, which accepts null. */
struct glance *glance_new(const struct track_clip *clip, const struct track_subject *subject, const struct track_conf *conf);
void glance_free(struct glance *glance);

/* Sets the frame's evidence, valid until the next call, of the eyes that are in it: round where its pose has them. frame->rgb must hold what lies there. */
void glance_at(struct eye_frame *frame, struct glance *glance, const bool in[SIDES]);

/* What that tells of the openings. */
struct glance_told {
	struct eye_told told[SIDES];
	const struct eye_told *known[SIDES];  // into told; null: nothing of that eye
	double radius;                        // px, of the irises as the pose has them
};
void glance_tell(struct glance_told *told, const struct eye_frame *frame, const struct glance *glance);

/* The pair of eyes in all of a frame, rgb [height][3 width]: middles of the irises, px. False: none is found. */
bool glance_find(double eye[SIDES][2], struct glance *glance, const uint8_t *rgb);

#endif
