/* eye_mesh: a fitted eye as triangle meshes (part.h). */
#ifndef EXPORT_EYE_MESH_H
#define EXPORT_EYE_MESH_H
#include "export/part.h"

/* IRIS: the fitted relief from the pupil's margin to the root, with a lip that turns back at the margin. Its normals are those of the iris
 * plane: the normal map holds the relief's, whatever the number of triangles. Morph targets: EXPORT_PUPILS.
 * BACK: a dark disc behind the pupil. SCLERA: from the seam (outside.h) to the back. CORNEA: from the apex to the seam. */
enum export_part_name { EXPORT_IRIS, EXPORT_BACK, EXPORT_SCLERA, EXPORT_CORNEA, EXPORT_PARTS };
extern const char *const export_part_names[EXPORT_PARTS];

/* Diameters of the pupil at weight 1 of the two targets, mm. With weights w the diameter is d0 + sum of w (target - d0), d0 the fitted one;
 * tissue moves along radii in proportion to its distance from the root, as the iris paper has it for the texture. */
extern const double export_pupils[EXPORT_TARGETS];
extern const char *const export_pupil_names[EXPORT_TARGETS];

/* Strength of the iris' normal map: tissue that scatters light inside follows the slope of its surface about half as much as a Lambertian
 * surface does, and the albedo holds the relief's own shadows. Measured: the iris' mean light in Cycles is 0.73 of the renderer's at 1,
 * 0.97 at 0.5. */
extern const double export_normal_scale;

struct export_mesh_conf {
	int iris_rings, around;   // rings of iris, twice those of cornea and sclera; vertices on each
};

/* Distance from the axis at which the iris ends, behind the limbus, mm. */
double export_iris_root(const struct scene *scene);

/* Half-widths of what the square textures show, mm: the iris maps; the cornea's. The sclera's map is azimuthal equidistant:
 * the angle at the sphere's centre runs to SCENE_SCLERA_REACH. Rows run downwards, so v of glTF does, too. */
double export_iris_extent(const struct scene *scene);
double export_cornea_extent(const struct scene *scene);

/* parts [EXPORT_PARTS], overwritten; export_part_free each. */
void export_eye_meshes(struct export_part parts[EXPORT_PARTS], const struct scene *scene, const struct export_mesh_conf *conf);

#endif
