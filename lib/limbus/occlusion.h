/* occlusion: what hides an iris, place by place: the chance that lid, lash or sclera covers it, that a reflection lies over it, or that it is the pupil, from a small
 * convolutional network (config/occlusion.onnx; tests/evidence/README.md) that sees the disc of the limbus alone, always at the same size, and what the evidence says of it.
 * Frame  (u, v) = 1 / S (p - c) of the ellipse (S as in math/ellipse.h): upright as the photograph, the limbus is the unit circle. Cell (i, j) of a side of n is
 *        centred at u = OCCLUSION_REACH (2 (i + 0.5) / n - 1), v likewise.
 */
#ifndef LIMBUS_OCCLUSION_H
#define LIMBUS_OCCLUSION_H
#include "limbus/evidence.h"
#include "math/ellipse_fit.h"

enum { OCCLUSION_SIDE = 128, OCCLUSION_CELLS = 64, OCCLUSION_SEEN = 7, OCCLUSION_PLANES = 8 };
#define OCCLUSION_REACH 1.2

enum occlusion_class { OCCLUSION_IRIS, OCCLUSION_PUPIL, OCCLUSION_MIRROR, OCCLUSION_LID, OCCLUSION_CLASSES };

/* Samples an eye: encoded red, green, blue, 0..1; chances of iris or pupil, sclera, lash, reflection. */
void occlusion_sample(float out[OCCLUSION_SEEN][OCCLUSION_SIDE][OCCLUSION_SIDE], const struct photo *photo, const struct evidence *evidence, const struct ellipse *e);

/* px of the photograph at (u, v). */
void occlusion_place(double p[2], const struct ellipse *e, double u, double v);

struct occlusion_net;

/* Loads the network. False, err set: the file is missing, damaged or of another shape. occlusion_close, which accepts null. */
bool occlusion_open(struct occlusion_net **net, const char *path, struct err *err);
bool occlusion_open_shipped(struct occlusion_net **net, struct err *err);
void occlusion_close(struct occlusion_net *net);

struct occlusion {
	double origin[2], cells[2][2];  // centre of the ellipse, px; cells for a px from there
	float p[OCCLUSION_CLASSES][OCCLUSION_CELLS][OCCLUSION_CELLS];  // they sum to 1
};

/* The mean of what the network says of an eye and of its mirror image. */
bool occlusion_read(struct occlusion *out, struct occlusion_net *net, const struct photo *photo, const struct evidence *evidence, const struct ellipse *limbus, struct err *err);

/* The chance of a class at (x, y) px of the photograph, bilinear; beyond the cells that of the nearest. */
float occlusion_at(const struct occlusion *occlusion, enum occlusion_class class, double x, double y);

#endif
