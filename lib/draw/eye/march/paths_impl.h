/* paths_impl: fields of the paths of light into one eye; shared by paths.c and paths_flat.c. */
#ifndef DRAW_EYE_MARCH_PATHS_IMPL_H
#define DRAW_EYE_MARCH_PATHS_IMPL_H
#include <string.h>

#include "draw/eye/march/paths.h"

/* Unit direction from the point to where the light comes in, irradiance of a plane that faces it, and the place on the cornea. */
enum { DIR_X, DIR_Y, DIR_Z, POWER, AT_X, AT_Y, CHANNELS };
/* On the iris plane: its irradiance, and the place on the cornea. */
enum { PLAIN_FALL, PLAIN_X, PLAIN_Y, PLAIN_CHANNELS };
enum { ANGLES = 64, RINGS = 24, TURNS = 64, WRAP = 4, ROW = TURNS + WRAP, FIELD = RINGS * ROW };
enum { PLAIN_FINER = 2, PLAIN_RINGS = PLAIN_FINER * (RINGS - 1) + 1, PLAIN_FIELD = PLAIN_RINGS * ROW };  // the limbus stops light within a step of RINGS

/* A point of the iris among a field's nodes: cubic weights of four rings and of four turns, and the first node. */
struct paths_place {
	float ring[4], turn[4];
	int first;
};

struct scene_paths {
	double most;                                         // radius of the last ring, mm
	float field[2][ANGLES][CHANNELS][FIELD];             // a row is a ring, and its first turns once more
	float plain[ANGLES][PLAIN_CHANNELS][PLAIN_FIELD];
	struct paths_place coarse[SCENE_COARSE * SCENE_COARSE];  // nodes of a beam's table
	struct paths_place flat[SCENE_FLAT * SCENE_FLAT];        // texels of flat light
};

/* A light among the fields: the first of four angles and their weights; by how many turns its field is turned about the axis. */
struct paths_light {
	int angle, turn;
	float in_angle[4], in_turn[4], cosine, sine;
};

/* dir: unit, towards the light, in the eye's frame; z at most 0.16. */
struct paths_light scene_paths_light(const float dir[3]);

/* Interpolates one ring of the light's field: n (TURNS or ROW) turns. field: the ring in the field of the first angle; those of the next
 * angles follow `apart` numbers on. */
SIMD_INLINE void scene_paths_row(float *restrict out, int n, const float *restrict field, long apart, const struct paths_light *light)
{
	const float *restrict a = field, *restrict b = a + apart, *restrict c = b + apart, *restrict d = c + apart, *p = light->in_angle, *q = light->in_turn;
	float row[2 * ROW];
	SIMD_LOOP
	for (int i = 0; i < TURNS; i++)
		row[i] = row[i + TURNS] = p[0] * a[i] + p[1] * b[i] + p[2] * c[i] + p[3] * d[i];
	memcpy(row + 2 * TURNS, row, (2 * ROW - 2 * TURNS) * sizeof *row);
	const float *restrict from = row + light->turn;
	SIMD_LOOP
	for (int i = 0; i < n; i++)
		out[i] = q[0] * from[i] + q[1] * from[i + 1] + q[2] * from[i + 2] + q[3] * from[i + 3];
}

#endif
