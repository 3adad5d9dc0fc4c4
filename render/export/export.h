/* export: the fitted eye for other programs: work/export/. Meshes and maps are made in lib/export; here they become files.
 * eye.glb for close-ups, eye_lod1.glb and eye_lod2.glb for games; textures/ as PNG and EXR; eye.json: units, ranges of the maps, and what is
 * lost; blender_eye.py, engines.md: how to assemble it by hand; reference_*.exr and studio.exr: the renderer's own pictures and their light. */
#ifndef RENDER_EXPORT_EXPORT_H
#define RENDER_EXPORT_EXPORT_H
#include <jansson.h>

#include "export/eye_glb.h"
#include "export/eye_maps.h"
#include "export/loss.h"
#include "render/render.h"

enum { EXPORT_LODS = 2, EXPORT_VIEWS = 3 };

struct export_conf {
	int texture_px, face_px;
	struct export_mesh_conf mesh;
	double lod_triangles[EXPORT_LODS];
	bool make, exr;
};

#define EXPORT_OPTS(c) \
	OPT_INT("export.texture_px", &(c)->texture_px, 256, 8192, "px", "width of an exported eye's textures, at most"), \
	OPT_INT("export.face_px", &(c)->face_px, 64, 8192, "px", "the same of the eyes in a driven face's file"), \
	OPT_INT("export.iris_rings", &(c)->mesh.iris_rings, 16, 512, "", "rings of vertices from pupil to root; cornea and sclera have half as many"), \
	OPT_INT("export.around", &(c)->mesh.around, 32, 1024, "", "vertices round the axis; the iris has twice as many"), \
	OPT_REALS("export.lod_triangles", (c)->lod_triangles, EXPORT_LODS, 100, 1e6, "", "triangles of an eye in games, near and far"), \
	OPT_BOOL("export.make", &(c)->make, "with the pictures; no: by make export alone"), \
	OPT_BOOL("export.exr", &(c)->exr, "textures as 16-bit EXR, too")

/* What one eye's files are made from. */
struct export_work {
	struct job *job;
	const struct export_conf *conf;
	struct export_part parts[EXPORT_PARTS];
	struct export_part margin[EXPORT_MARGIN_PARTS];  // of the capture's first character, round the eye; where it has one
	bool has_margin;
	double hair_rgb[3];
	struct image maps[EXPORT_MAPS];
	struct export_png png[EXPORT_MAPS], pictures[EXPORT_PICTURES];
	double low[EXPORT_MAPS], high[EXPORT_MAPS];   // what 0 and 255 stand for
	struct image reference[EXPORT_VIEWS];
	struct export_loss loss[EXPORT_VIEWS];
	long bytes[1 + EXPORT_LODS];                  // of the three files, and what is in them
	int triangles[1 + EXPORT_LODS], vertices[1 + EXPORT_LODS];
	double error_mm[1 + EXPORT_LODS];             // of the simplified meshes, as meshoptimizer states it
};

/* export.c: the parts of a file for games: grids of fewer vertices, and of the iris, whose relief has detail here and none there, the
 * triangles that meshoptimizer leaves of a finer grid; at most `triangles` in all, unless that is below some hundreds. parts: overwritten; all: triangles of
 * the close-up mesh of conf; error_mm: of the simplified iris, as meshoptimizer states it. */
void export_fewer(struct export_part parts[EXPORT_PARTS], double *error_mm, const struct scene *scene, const struct export_mesh_conf *conf, long all,
                  double triangles);

/* in_face.c: an eye for a driven face's file, whether a photograph was fitted to it or not: the nearer of the meshes for games, textures
 * of at most conf->face_px. out: bytes of a binary glTF (export/eye_glb.h), free(). lit: as export_eye_maps has it. Returns false, err set,
 * where resampling or compression fails. */
bool export_in_face(char **out, size_t *size, const struct scene *scene, const struct envmap *lit, const struct export_conf *conf, struct err *err);

/* Makes what is not fresh, from the job's scene; lashes and tears from the first character of `faces`. */
struct skin_job;
bool export_eye(struct job *job, const struct export_conf *conf, struct skin_job *faces, struct err *err);

/* encode.c: PNG of all maps and of the pictures that a .glb embeds, in parallel; in work->png and work->pictures. */
bool export_encode(struct export_work *work, struct err *err);
void export_work_free(struct export_work *work);

/* statement.c: eye.json. json_decref. */
json_t *export_statement(const struct export_work *work);

#endif
