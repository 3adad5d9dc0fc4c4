/* photo: what the renderer takes from a photograph of the eye: its place in the iris maps, its light, its vessels; and the
 * comparison of a rendering with it.
 * A shot is one photograph with its fit. Its view is the window of the photograph that is drawn, at a size of its own:
 * view px (x, y) is photo px (window[0] + x scale, window[1] + y scale). Image px: x right, y down, centre of the first pixel
 * at (0.5, 0.5). Directions are in the camera's frame (x right, y down, z forward), unit length. Colours linear Rec. 709.
 */
#ifndef DRAW_PHOTO_PHOTO_H
#define DRAW_PHOTO_PHOTO_H
#include <stdbool.h>

#include "anatomy/capture.h"
#include "anatomy/fit.h"
#include "draw/eye/view.h"
#include "iris/unrefract/unrefract.h"
#include "limbus/evidence.h"

/* One photograph with its fit. */
struct shot {
	const struct capture_photo *photo;
	struct fit fit;
	struct image image;              // the window, linear, at the size of its view; px null: not decoded yet
	struct evidence told;            // what each of its pixels shows; planes null: not asked
	struct envmap env, lamps;        // its light; what the cornea mirrors beyond what is in the texture already
	int n_lamps;
	double window[4], scale;         // x0, y0, x1, y1 photo px; photo px a pixel of the view
	double slip[2][3];               // as in struct scene_view
	float lids[3 * UNREFRACT_LIDS * UNREFRACT_LIDS];  // what lids left of the light on the iris there (lids.h), [3][UNREFRACT_LIDS][UNREFRACT_LIDS]
	double lids_extent;              // half-width of that square of the maps, mm; 0: all of it
};

/* The photograph's own view. */
struct scene_view shot_view(const struct shot *shot);

/* Rotates the eye frame of shot->fit about the optical axis into the frame of the merged iris maps, by the registration
 * (photo_from_map) that unrefract wrote for this photograph. What a rotation does not explain goes into shot->slip.
 * texture_json: path; a missing file, or one that does not name the photograph, leaves the shot as it is.
 * Returns false, err set, when the file cannot be read or the registration is far from a rotation. */
bool shot_align(struct shot *shot, const char *texture_json, struct err *err);

/* Distance of (x, y) from the ellipse's centre in semi-axes: 1 on the ellipse, more outside. */
double ellipse_radius(const struct ellipse *e, double x, double y);

/* Estimates the light in the photograph: lamps from their mirror images in the cornea, in a room that gives the rest of
 * the light. Where the cornea mirrors no lamp, the studio.
 * shot    decoded; eye: its cornea
 * height  rows of the maps
 * white     what white that faces the camera shows in it: lamps are so bright against the rest of the light
 * balanced  the photograph's white is told: the light is over it. Else its lamps' colours, as far as they are not clipped, stand for it
 * lamps   out, in the photograph's colours: the lamps alone, black elsewhere; n: how many
 * Returns the whole light, of the level of envmap_normalise. envmap_free both. */
struct envmap light_of_photo(const struct shot *shot, const struct eye *eye, int height, const double white[3], bool balanced, struct envmap *lamps, int *n);
/* A photographer's studio: key, fill and a strip from above. envmap_free. */
struct envmap light_studio(int height);
/* Other surroundings of the same level: a room with daylight from a window of four panes at the left; an overcast sky. */
struct envmap light_window(int height);
struct envmap light_sky(int height);

/* How a rendering differs from its photograph where the iris texture has weight: off pupil, lids and reflections. */
struct shot_difference {
	long n;                          // pixels compared; 0: mean and high are not set
	double mean, high;               // CIEDE2000: mean and 95th percentile
};

/* Photograph, rendering and their difference (sRGB values, four times, about middle grey), side by side and
 * COMPARE_GAP px apart.
 * view    rendering of shot_view(shot), as large as shot->image
 * Returns the picture, linear; image_free. */
enum { COMPARE_GAP = 6 };
struct image compare_shot(struct shot_difference *difference, const struct scene *scene, const struct shot *shot, const struct image *view);

/* The difference alone. */
struct shot_difference compare_numbers(const struct scene *scene, const struct shot *shot, const struct image *view);

#endif
