/* portrait: a picture of a driven character: skin as a smooth surface lit by an environment, with the eyes of draw/eye in it.
 *
 * Frames   the rig's (mm) and the camera's (x right, y down, z forward). The environment map is in the camera's frame.
 * Skin     Phong tessellation of the mesh round the eyes (Boubekeur and Alexa 2008; it keeps the vertices); irradiance
 *          with shadows at the vertices, subsurface scattering on the screen (image/subsurface), and rough reflection.
 * Colour   linear Rec. 709; a white plane facing the camera has value 1.
 */
#ifndef DRAW_FACE_PORTRAIT_H
#define DRAW_FACE_PORTRAIT_H
#include "draw/eye/scene.h"
#include "draw/face/dress.h"
#include "rig/hair/hair.h"
#include "rig/deform/deform.h"
#include "draw/face/wrinkle_map.h"

struct portrait_conf {
	int lights;            // directions sampled from the environment
	int subdivide;         // times the triangles near the eyes are cut in four
	int samples;           // samples^2 of a pixel where it shows more than one thing
	int eye_samples;       // the same inside the eyes
	double skin_rgb[3];    // albedo
	double texture;        // strength of pores and blotches: 1 as on a face, 0 none
	double scatter_mm;     // how far red light travels in skin: 1.5 times the root mean square; 0: not at all
	double tear_mm;        // height of the tear line along the lids; 0: none, and no dark under their edges
	double tear_absorb[3]; // absorption of tear fluid, 1/mm
	double caruncle_wet;   // 0..1: how moist and red the inner corners are
	struct hair_conf hair; // lashes and brows
	double hair_rgb[3];    // their albedo
	const struct dress *dress;  // the character's own textures; null: skin of one colour. Outlives the portrait
};

/* Camera of one frame. */
struct portrait_view {
	double cam_from_target[3][4];
	double focal_px, center_px[2];
	int width, height;
};

struct portrait;

/* The character of a rig. env: mapped environment; eyes: left, right; those and rig must outlive the portrait. portrait_free, which
 * accepts null. portrait_pose and portrait_light before the first picture. */
struct portrait *portrait_new(const struct rig *rig, const struct scene *const eyes[2], const struct envmap *env,
                              const struct portrait_conf *conf);
void portrait_free(struct portrait *portrait);

/* Its lashes and brows. */
const struct hairs *portrait_hairs(const struct portrait *portrait);

/* Gives it the wrinkles of expressions. Each map follows the action unit of its name (au_names [n_au]) in strength; maps of other
 * names do nothing. maps must outlive the portrait. */
void portrait_wear(struct portrait *portrait, const struct wrinkle_maps *maps, int n_au, char *const au_names[]);

/* Poses mesh and globes. controls: g~ [rig.n_inputs] (skin paper, algorithm 1). */
void portrait_pose(struct portrait *portrait, const double *controls);

/* Computes irradiance and shadows at the vertices, for the camera that the environment goes with. all: of every vertex; else of those
 * that have moved since the last call. */
void portrait_light(struct portrait *portrait, const struct portrait_view *view, bool all);

/* Returns [height][width][4]: linear RGB and A (cover), premultiplied; image_free. The same bytes for any number of threads. */
struct image portrait_draw(struct portrait *portrait, const struct portrait_view *view);

/* Layers of a picture that portrait_draw made in the same view, a channel each:
 * Z          depth along the camera's axis, mm; 0 where nothing is.
 * DISTANCE   from each point of the globes to the place of the globe that the lid's edge hides, in view space, mm; INFINITY off the globes and
 *            more than PORTRAIT_REACH_MM from it.
 * LAKE       depth of the tear fluid there, mm; 0 where there is only the film.
 * NORMAL     unit, in the camera's frame; 0 where nothing is, or where a globe ends.
 * DIFFUSE, SPECULAR   RGB each; together the picture.
 * image_free. */
#define PORTRAIT_REACH_MM 12.0
enum portrait_layer { PORTRAIT_Z, PORTRAIT_DISTANCE, PORTRAIT_LAKE, PORTRAIT_NORMAL, PORTRAIT_DIFFUSE = PORTRAIT_NORMAL + 3,
	                  PORTRAIT_SPECULAR = PORTRAIT_DIFFUSE + 3, PORTRAIT_LAYERS = PORTRAIT_SPECULAR + 3 };
struct image portrait_layers(struct portrait *portrait, const struct portrait_view *view, const struct image *picture);

/* A view from the front of both eyes (side < 0) or one (0 left, 1 right), field mm across, turned by yaw and pitch (rad). */
struct portrait_view portrait_front(const struct rig *rig, int side, double field, double yaw, double pitch, int width, int height);

#endif
