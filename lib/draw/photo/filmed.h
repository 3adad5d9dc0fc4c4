/* filmed: the iris of an eye as frames of a film show it, without its cornea, for a character whose eyes nobody photographed.
 *
 * Every frame is laid onto the plane of the iris by its pose and the light's path through the cornea (iris/iris_map.h); frames are brought to one
 * exposure, and of what they show at a place the middle is kept, so that lights mirrored in the cornea, which stay where they are while the eye
 * turns, fall out. Colours: linear Rec. 709 over white, by the sclera beside the iris.
 */
#ifndef DRAW_PHOTO_FILMED_H
#define DRAW_PHOTO_FILMED_H
#include <stdint.h>

#include "anatomy/fit.h"
#include "draw/eye/seen.h"

enum { FILMED_VIEWS = 24 };

/* A frame: [height][width][3] sRGB, with camera and cam_from_eye of fit, width and height. The margins of both lids are polylines of n points, px, from one
 * corner to the other: upper[n][2], lower[n][2]. */
struct filmed_view {
	const uint8_t *rgb;
	const struct fit *fit;
	const float (*upper)[2], (*lower)[2];
	int n;
};

struct filmed;

/* eye: copied. sclera_rgb: albedo of a healthy sclera. sclera_radius: of the eyeball, mm of the eye's frame. filmed_free, which accepts null. */
struct filmed *filmed_new(const struct eye *eye, double sclera_radius, const double sclera_rgb[3]);
void filmed_free(struct filmed *filmed);

/* Adds a frame, at most FILMED_VIEWS. The pixels are read at once. */
void filmed_add(struct filmed *filmed, const struct filmed_view *view);

/* Share of the iris that frames show, before they are laid onto each other. */
double filmed_share(const struct filmed *filmed);

struct filmed_report {
	double px;     // across the iris, in the mean
	double share;  // of the iris that is seen, 0..1
	int views;     // that show some of it
};

/* Makes the iris. seen: overwritten; scene_seen_free. Returns false, err set to the reason (a sentence's end), where it shows too little of one, or no white. */
bool filmed_make(struct scene_seen *seen, struct filmed_report *report, struct filmed *filmed, struct err *err);

#endif
