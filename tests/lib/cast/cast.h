/* cast: a ray caster of eyes in faces, to judge by. It shares no code with the generator of tests/evidence, with other test scenes or
 * with the product, but random numbers and the conic through points.
 * An aspheric cornea that refracts, an elliptic limbus, a flat iris of bundled fibres, an eyeball with vessels, lids with thickness on a
 * relief of skin, lashes in space, lamps that throw the upper lid's shadow, a room mirrored in the cornea, a camera with perspective.
 * Frame  camera: x right, y down, z forward, mm.
 */
#ifndef TESTS_CAST_H
#define TESTS_CAST_H
#include <stdbool.h>
#include <stdint.h>

#include "math/ellipse.h"
#include "math/rng.h"

/* Where the eye is to be: px; radians. */
struct cast_frame { int width, height; double radius, x, y, turn; bool left, animal; };  // animal: the iris fills the opening, its pupil a slit

struct cast_truth {
	struct ellipse limbus;  // px: the middle of the ramp from iris to sclera, in linear light
	struct ellipse pupil;   // through the points where its margin is seen through the cornea
	double showing;         // share of the limbus that no lid, lash or reflection hides and that is in the picture
	double opening;         // of the lids over the limbus's diameter
	double theta;           // radians between the optical axis and the direction to the camera
	double warmth;          // red over blue of what is white, in the picture's linear light
	double aspect;          // of the limbus: vertical over horizontal
	double focal_px;
};

/* A photograph drawn from random numbers: [height][width][3] bytes, free(). */
uint8_t *cast_render(struct cast_truth *truth, const struct cast_frame *frame, struct rng *rng);

#endif
