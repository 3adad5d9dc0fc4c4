/* scene: eyes and faces drawn from a number, with the class of every pixel, to train and to test the network that tells iris
 * from sclera, lid, lash and reflection.
 * A model of its own: nothing of the product's limbus or renderer is in it. Pictures of the test split share no texture with
 * those for training, and some families of irises, lids, lashes and lights are drawn there alone.
 */
#ifndef EVIDENCE_SCENE_H
#define EVIDENCE_SCENE_H
#include <stdbool.h>
#include <stdint.h>

#include "limbus/evidence.h"

/* px of the picture, centre of the first at 0.5; angle in radians from x towards y (down). */
struct drawn_eye {
	float limbus[5], pupil[5];  // x, y, semi-axes, angle
	float openness;             // height of the opening over the limbus's diameter; 0 closed
	float theta;                // radians between the gaze and the direction to the camera
	float shown;                // share of the limbus's disc that neither lid nor the picture's edge hides
};

struct drawn {
	int width, height;
	uint8_t *rgb, *label;  // [height][width][3], [height][width]
	float *mirror, *body;  // [height][width], before lens and noise, white is 1: luminance that eyes and glasses mirror, and that of what lies below it; may be null
	int n_eyes;
	struct drawn_eye eye[2];
	float aspect;          // of their limbi, vertical over horizontal, of the eye
	float white[3];        // linear colour in which a white surface is shown
	int light;             // enum light_kind
	int iris;              // enum iris_family
	int other;             // 0 an eye; else which kind of picture without one
};

/* Picture `number` of a split; every second one of the training split as photographs of people are (portrait.h). drawn_free. Not for several threads at once. */
struct drawn drawn_make(uint64_t number, bool test, int width, int height);

/* A photograph for measuring by: of the test split unless training is set, the limbus a ramp of equal halves (ball.h), one eye's limbus where it is asked for.
 * rough: 0 a clean limbus; up to 1 softer, ragged, with vessels up to it, and a poorer camera. other: 0, or what to draw instead of an eye
 * (other.h). portrait: as photographs of people are (portrait.h). around: it mirrors surroundings (around.h). Otherwise as drawn_make. */
struct drawn_view { float radius, x, y, turn, rough; bool mirrored; int other; bool training, portrait, around; };  // limbus's larger semi-axis and centre, px; radians
struct drawn drawn_photograph(uint64_t number, const struct drawn_view *view, int width, int height);
/* Photograph `number` of those that the limbus's measure learns from: of the training split, `least` to 2.4 times as many px long, the limbus
 * 24 px to two fifths of the height; one in five shows no eye, two in three are rough, half are portraits. view: set. drawn_free. */
struct drawn drawn_lesson(uint64_t number, int least, struct drawn_view *view);
void drawn_free(struct drawn *drawn);

#endif
