/* skin_tracked: what was tracked of the person in a video, as a character's skin is made of it. */
#ifndef RENDER_FACE_SKIN_TRACKED_H
#define RENDER_FACE_SKIN_TRACKED_H
#include "base/npy/npy.h"
#include "optics/camera.h"
#include "render/face/skin.h"

enum { TRACKED_JSON, TRACKED_HEAD, TRACKED_SKIN, TRACKED_VERTICES, TRACKED_CONFIDENCE, TRACKED_LIDS, TRACKED_FILES, TRACKED_MARGINS = 4 };
extern const char *const tracked_files[TRACKED_FILES];  // relative to the capture

/* Owned; tracked_free. Shapes and types as lib/README.md has them, checked. */
struct tracked {
	struct camera camera;
	int width, height, reference;
	long frames;
	double eye[2][3], radius;  // mm, the mesh's axes
	struct npy head, skin, vertices, sure, lids;
	struct mesh mesh;          // mm
};

/* Reads it. tracked: overwritten; tracked_free in any case. Returns false, err set, when a file is damaged, or they do not go together. */
bool tracked_load(struct tracked *tracked, struct skin_job *job, const struct skin_target *target, struct err *err);
void tracked_free(struct tracked *tracked);

#endif
