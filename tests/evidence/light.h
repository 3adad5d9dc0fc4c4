/* light: what shines on a drawn eye and what the wet cornea mirrors.
 * Frame  picture: x right, y up, z towards the camera.
 */
#ifndef EVIDENCE_LIGHT_H
#define EVIDENCE_LIGHT_H
#include "around.h"
#include "field.h"
#include "math/rng.h"

enum light_kind { LIGHT_WINDOW, LIGHT_SOFTBOX, LIGHT_LAMPS, LIGHT_FLASH, LIGHT_ROOM, LIGHT_SKY, LIGHT_FLAT,
	              LIGHT_RING, LIGHT_TREES, LIGHT_KINDS };  // the last two are drawn in the test split alone

enum { SOURCES_MAX = 8 };

struct source {
	float dir[3], side[3], up[3];  // towards it; its own axes
	float half[2];                 // half its extent, as tangents
	int shape;                     // 0 rectangle, 1 round, 2 ring, 3 rectangle with bars
	int bars[2];
	float radiance[3], irradiance[3];  // mirrored; shining on what it lights
};

struct light {
	enum light_kind kind;
	int n;
	struct source source[SOURCES_MAX];
	float ambient[3], room[3];  // from all sides: irradiance; radiance that is mirrored
	float above, skyline;       // how much more is mirrored from above; height of the horizon, as y of a direction
	const struct field *clutter;
	float at[2], scale;         // where and how large the clutter is
	struct around around;       // off: none
	float shade_dir[2], shade_at, shade_soft, shade_depth, shade_period;  // a shadow's edge, or slats, over the face; mm
};

struct light light_make(struct rng *rng, bool test);

/* Axes of a source or window in direction (x, y) of the plane z = 1, leaning by so many radians. */
void source_axes(float dir[3], float side[3], float up[3], float x, float y, float lean);

/* Where direction d (unit) meets the plane of a source or window, against its half extents; false: nowhere, or far aslant. */
bool source_place(float at[2], const float dir[3], const float side[3], const float up[3], const float half[2], const float d[3]);

/* Radiance from direction d (unit). */
void light_mirrored(float out[3], const struct light *light, const float d[3]);

/* Irradiance of a surface of normal n, over pi; wrap 0..1 softens the terminator. Includes the ambient light. */
void light_on(float out[3], const struct light *light, const float n[3], float wrap);

/* Share of light that a cast shadow leaves at (u, v) mm of the face. */
float light_shade(const struct light *light, float u, float v);

/* Linear Rec. 709 colour of a black body, green 1. */
void light_colour(float rgb[3], float kelvin);

#endif
