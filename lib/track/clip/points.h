/* points: which points of skin are followed: vertices of the mesh round the eyes, spread over the picture. */
#ifndef TRACK_CLIP_POINTS_H
#define TRACK_CLIP_POINTS_H
#include "track/clip/clip.h"

struct track_points {
	int n;
	int32_t *vertex;       // [n] rows of the mesh
	double (*head)[3];     // [n] head frame, mm
	double (*normal)[3];   // [n] of the mesh there, head frame, unit length
	struct skin_points points;  // px in the reference frame, and neighbours
	uint8_t *mask;         // [height][width] 0 where the picture shows no skin, else 255
};

/* Whether a head posed so turns point i to the camera, not too steeply to be followed. */
bool track_points_face(const struct track_points *points, int i, const double cam_from_head[4][4]);

/* Chooses at most conf->points vertices that the camera sees at the reference, at least gap_px apart. points: overwritten;
 * track_points_free in any case. Without a mesh there are none. Returns false, err set, when a mesh has fewer than 20. */
bool track_points_choose(struct track_points *points, const struct track_clip *clip, const struct track_subject *subject,
                         const struct track_conf *conf, struct err *err);
void track_points_free(struct track_points *points);

#endif
