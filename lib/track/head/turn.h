/* turn: how a head is turned, as its face shows it: a network that has learnt from heads in three dimensions (tests/evidence/turned.py) reads a picture of the face whose
 * eyes lie level.
 * Head frame  x to the person's left, y up, z out of the face.  Image  px, centre of the first pixel (0.5, 0.5).
 */
#ifndef TRACK_HEAD_TURN_H
#define TRACK_HEAD_TURN_H
#include <stdint.h>

#include "base/err.h"
#include "optics/camera.h"

struct turn_net;

/* config/turn.onnx beside the programs, or another file. False, err set, where it is missing, damaged, or another kind of network. turn_close accepts null. */
bool turn_open(struct turn_net **net, const char *path, struct err *err);
bool turn_open_shipped(struct turn_net **net, struct err *err);
void turn_close(struct turn_net *net);

enum { TURN_ASIDE, TURN_NOD, TURNS };

/* Radians, against one that faces along the line of sight to the middle between its eyes, its eyes level: Ry(aside) Rx(nod) in the head's axes. */
struct head_turn {
	double angle[TURNS];
	double sigma[TURNS];   // standard deviations
	double unlike;         // what the network itself says of them, rms: small of a face such as it has learnt, large of what is none
};

/* What turn_see reads of a picture of that size: x0, y0, x1, y1, px. eye: middles between the corners of the person's left and right eye, px. False where that is nothing. */
bool turn_reach(int box[4], const double eye[2][2], int width, int height);

/* rgb[height][3 width]. False, err set, where the network does not run. */
bool turn_see(struct head_turn *turn, struct turn_net *net, const uint8_t *rgb, int width, int height, const double eye[2][2], struct err *err);

/* The rotation of a head that is turned so, leans by `lean` in the picture (radians, from x to y), and whose eyes' middle lies on `ray` (camera frame, any length). */
void turn_rotation(double cam_from_head[3][3], const double angle[TURNS], double lean, const double ray[3]);

/* The inverse: angles and lean of a rotation seen along ray. */
void turn_of(double angle[TURNS], double *lean, const double cam_from_head[4][4], const double ray[3]);

#endif
