/* ball: a drawn eyeball: sclera, refracting cornea, iris, pupil and what the wet surface mirrors.
 * Frame  millimetres about the ball's centre as the picture shows it: x right, y up, z towards the camera; the camera is
 *        far away. The cornea is a sphere, the aqueous behind it reaches to the flat iris.
 */
#ifndef EVIDENCE_BALL_H
#define EVIDENCE_BALL_H
#include "iris.h"
#include "light.h"

struct ball {
	float radius, limbus, cornea, depth;  // of ball, limbus across, cornea; the iris plane behind the limbus plane
	float aspect;                         // the limbus's height over its width: the sclera reaches over the cornea above and below
	float gaze[3], side[3], up[3];        // unit
	float to_limbus, to_cornea;           // along the gaze from the centre: limbus plane, cornea's centre
	float pupil, pupil_at[2], pupil_wave[2], haze;
	float blur, ragged;                   // of the limbus, mm: width of its ramp; how far that strays
	float near_limbus;                    // mm from the limbus at which vessels have their full strength
	float sclera[3], canthus[3], vessels, vessel_scale, at[2], red;
	const struct field *veins, *stain;
	float wet, shine;                     // the tear film on the sclera: unevenness, how much it mirrors
	bool even;                            // the limbus is a ramp of equal halves about its outline, in linear light: truth to a fraction of a px
	struct iris iris;
};

struct ball ball_make(struct rng *rng, bool test);
/* Turns the gaze to (x, y) = sines to the right and up. */
void ball_look(struct ball *ball, float x, float y);

struct ball_point {
	int label;        // enum evidence_class without reflections
	float body[3];    // diffusely reflected
	float mirror[3];  // added by reflection
};
void ball_at(struct ball_point *out, const struct ball *ball, const struct light *light, float x, float y);

/* Ellipse of the limbus or the pupil in the ball's frame: x, y, semi-axes, angle (radians, counterclockwise, y up). That of a limbus
 * that is ragged or no circle is the one which fits the middle of its ramp best. The pupil's is that of a circle magnified and lifted by the cornea's refraction, good to some per cent. */
void ball_limbus(float ellipse[5], const struct ball *ball);
void ball_pupil(float ellipse[5], const struct ball *ball);

#endif
