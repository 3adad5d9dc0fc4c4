/* complexion: the skin of a person as a film, or photographs round the head, show it, with the light taken off, and characters that wear it.
 *
 * Frames of the film are laid onto the person's mesh, each point of skin being what most of them show; hairs, openings of the eyes and
 * what is over- or underexposed are left out. Light is smooth over the directions: nine numbers a colour (spherical harmonics to order
 * 2, Ramamoorthi and Hanrahan 2001; what the head itself hides left out, Sloan, Kautz and Snyder 2002), fitted robustly to skin of one
 * colour. What those do not explain and differs between the two halves of the face over centimetres is light, too: skin is alike there.
 * What no frame shows is taken from the other half of the face, then from the skin around; its grain is drawn as strong at each size, and
 * as skewed, as that of the skin seen. Of lashes and brows it is measured how much they hide, how far they reach, which way they grow. Colours: linear Rec. 709 albedo; their scale by the white of the eyes.
 */
#ifndef DRAW_COMPLEXION_COMPLEXION_H
#define DRAW_COMPLEXION_COMPLEXION_H
#include "character/look.h"
#include "draw/complexion/chart.h"
#include "mesh/mesh.h"
#include "rig/hair/hair.h"

struct complexion;

struct complexion_conf {
	int side;               // px of a character's textures
	double sclera_rgb[3];   // of a healthy eye
	double skin_rgb[3];     // albedo whose brightness stands where the eyes' white tells none
	double bumps;           // rms slope of pores and fine wrinkles
};

/* A frame of the film. */
struct complexion_view {
	const uint8_t *rgb;     // [height][width][3] sRGB
	int width, height;
	const float (*at)[3];   // [vertices] of the mesh: px, and mm before the camera; NAN: not known
	double focal_px;
	const uint8_t *open;    // [height][width] where the eyes are open, which shows no skin
	const float (*lids)[2]; // [4][lid_points] px: margins of the left eye's upper and lower lid, of the right's; null: not known
	int lid_points;
	const uint8_t *eyes;    // [height][width] where that is sure, and shows the eyes; null: as open
};

/* What was found, for the log and the reader. */
struct complexion_report {
	double seen, mirrored;  // shares of the face within 60 mm of the eyes: in the film, from the other half
	double rgb[3];          // median albedo
	double light[3];        // direction that the most light comes from, head frame, unit
	double grain;           // rms of the grain's ln
	bool white;             // the scale is that of the eyes' white
};

/* mesh: the person's, mm, x to the left, y up, z out of the face; with its eyeballs (left, right) it outlives the result.
 * complexion_free, which accepts null. */
struct complexion *complexion_new(const struct mesh *mesh, const double eye[2][3], double radius, const struct complexion_conf *conf);
void complexion_free(struct complexion *complexion);

/* Adds a frame, at most COMPLEXION_VIEWS; the first is the one that others are compared with, and whose eyes tell white. */
enum { COMPLEXION_VIEWS = 12 };
void complexion_add(struct complexion *complexion, const struct complexion_view *view);

/* Makes the map of what was added. Returns false, err set to the reason, where it is too dark, too bright, or too little of the face. */
bool complexion_make(struct complexion *complexion, struct complexion_report *report, struct err *err);

/* Albedo of the skin at a place of the person's head, 0..1, and how much of it the film or the other half of the face shows. */
float complexion_at(float rgb[3], const struct complexion *complexion, const float x[3]);

/* Lashes and brows that the film shows; belongs to the complexion. After complexion_make. */
const struct hair_film *complexion_hair(const struct complexion *complexion);

/* A character to wear it: n vertices at rest (mm, its own axes) and where they lie on the person (mm). */
struct complexion_wearer {
	int n, n_faces;
	const int32_t (*faces)[3];
	const float (*rest)[3], (*normal)[3], (*registered)[3];
	const bool *skin;       // [n_faces]
	const float *margin;    // [n] 0..1: how far it is the lids' margin, which is redder
	double eye[2][3], head_from_rest[3][3];
};

/* Makes its look: texture coordinates, one material, textures of colour and normals. look_free. Returns false, err set, where they
 * cannot be encoded. */
bool complexion_wear(struct look *look, const struct complexion *complexion, const struct complexion_wearer *wearer, struct err *err);

#endif
