/* face: skin round drawn eyes: relief, colour, brow, nose, mouth, hair of the head, and what is behind it. */
#ifndef EVIDENCE_FACE_H
#define EVIDENCE_FACE_H
#include "field.h"
#include "lids.h"

struct face {
	float melanin, blood, oil, rough, wrinkle, spots, ring;  // ring: darker skin round the eyes
	float depth, nose_wide, nose_shift, nose_length, socket, half[2], half_at;
	float mouth_at, mouth_wide, mouth_open, lip[3], hairline, hair[3], beard;
	float narrow;                                   // cosine of the head's turn
	float at[2], turn;                              // where textures lie
	const struct field *fine, *lines, *blotch, *strands, *behind[2];
	float back[2][3], back_scale, back_busy;        // busy: contrast of its texture, 1 full
	float neck, shoulder, slope, body_wide, cloth[3], hair_down, hair_out, hair_curl;  // half widths, heights, mm; how far hair stands out
	bool bare_body;
	const struct field *weave, *curls;
	struct lids lids[2];
	struct eye_frame frame[2];
};

struct face drawn_face_make(struct rng *rng, bool test);

/* Height (mm, towards the camera), albedo and shine of the skin at (u, v); occlusion 0..1 of ambient light. False: behind the
 * face; albedo is then the background's radiance. */
struct skin_point { float height, albedo[3], open; };
bool drawn_face_at(struct skin_point *out, const struct face *face, float u, float v);

#endif
