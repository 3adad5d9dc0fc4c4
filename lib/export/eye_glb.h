/* eye_glb: a fitted eye as binary glTF 2.0. Metres, y up, the eye looks along +z; nodes: the eye, and below it its parts (eye_mesh.h).
 * The cornea is a volume of the fitted index (KHR_materials_transmission, _ior, _volume): a path tracer refracts in its true shape; a
 * rasteriser bends by its thickness map, exactly where it is looked at along the axis. The tear film is said in terms of its material: the
 * roughness maps of cornea and sclera are its own, and extras.tear_film of both materials has its index. */
#ifndef EXPORT_EYE_GLB_H
#define EXPORT_EYE_GLB_H
#include "export/eye_mesh.h"
#include "export/margin.h"

/* Pictures that a file embeds: PNG bytes. Channels: occlusion (white), roughness, metal (black); clear and depth as glTF has them. */
enum export_picture {
	EXPORT_PIC_IRIS,
	EXPORT_PIC_IRIS_NORMAL,
	EXPORT_PIC_SCLERA,
	EXPORT_PIC_SCLERA_ROUGH,
	EXPORT_PIC_CORNEA,
	EXPORT_PIC_CORNEA_VOLUME,  // red: share that goes through; green: depth over export_eye.depth_mm
	EXPORT_PIC_CORNEA_ROUGH,
	EXPORT_PICTURES
};

struct export_png {
	uint8_t *data;
	size_t size;
};

struct export_eye {
	const struct export_part *parts;    // [EXPORT_PARTS]
	const struct export_png *pictures;  // [EXPORT_PICTURES]
	double index, depth_mm;             // of the cornea's volume; that a value of 1 in its map stands for
	const char *name, *made_by;         // of the root node; JSON text, or null
	double pupil_mm;                    // diameter of the fitted pupil; in the iris' extras
	const struct export_part *margin;   // [EXPORT_MARGIN_PARTS]; null: none
	double hair_rgb[3];                 // of lashes, linear
};

/* The file's bytes; out: free(). Returns false, err set, where they are too many for a glTF. */
bool export_eye_pack(char **out, size_t *size, const struct export_eye *eye, struct err *err);

/* Writes them. bytes: the file's length, out. Returns false, err set, when it cannot. */
bool export_eye_glb(const char *path, const struct export_eye *eye, long *bytes, struct err *err);

#endif
