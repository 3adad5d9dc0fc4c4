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
	double eye[2][3], radius;  // mm, the mesh's axes; the mean of both
	double eye_radius[2], limbus[2];  // mm
	struct npy head, skin, vertices, sure, lids;
	struct mesh mesh;          // mm
};

/* Reads camera, eyes, head and lids alone: what a film without a mesh has, too. As tracked_load. */
bool tracked_load_eyes(struct tracked *tracked, struct skin_job *job, struct err *err);

/* Reads the person's mesh, mm, which work/targets/NAME/registration.json names: what tracked_load does, too. */
bool tracked_load_mesh(struct tracked *tracked, struct skin_job *job, const struct skin_target *target, struct err *err);

/* The same, and the person's skin. tracked: overwritten; tracked_free in any case. Returns false, err set, when a file is damaged, or they do not go together. */
bool tracked_load(struct tracked *tracked, struct skin_job *job, const struct skin_target *target, struct err *err);
void tracked_free(struct tracked *tracked);

/* Pose of the head in a frame, cam_from_head. */
const double (*tracked_pose(const struct tracked *tracked, long frame))[4];

/* Marks what lies between the lids of both eyes and so many px further to the sides, and up and down; below 0: less far. lids: [TRACKED_MARGINS][m] px; open: out, [height][width]. */
void tracked_mark_open(uint8_t *open, int width, int height, const float (*lids)[2], long m, const double further[2]);

/* Decodes n frames of the film, in their order there: take is given each that it has, [height][width][3] sRGB, which it has to free(). Returns false, err set. */
struct tracked_take {
	void (*take)(void *to, int i, uint8_t *rgb);
	void *to;
};
bool tracked_decode(int n, const long *frame, const struct tracked *tracked, struct skin_job *job, const char *path, const struct tracked_take *take, struct err *err);

#endif
