/* evidence: for each pixel the probability of being pupil, iris, sclera, lash or brow, reflection, or skin and all else, from a
 * small convolutional network (config/evidence.onnx; trained on drawn eyes: tests/evidence/README.md).
 * Coordinates are px of the photograph, centre of its first pixel (0.5, 0.5). A plane's pixel (i, j) is centred at
 * (x0 + (i + 0.5) scale, y0 + (j + 0.5) scale).
 */
#ifndef LIMBUS_EVIDENCE_H
#define LIMBUS_EVIDENCE_H
#include "base/err.h"
#include "image/photo/photo.h"

enum evidence_class { EVIDENCE_SKIN, EVIDENCE_LASH, EVIDENCE_SCLERA, EVIDENCE_IRIS, EVIDENCE_PUPIL, EVIDENCE_REFLECTION, EVIDENCE_CLASSES };

struct evidence {
	int width, height;
	double x0, y0, scale;            // photo px of the planes' corner; photo px in one of the planes'
	float *plane[EVIDENCE_CLASSES];  // [height][width]; at each pixel they sum to 1; plane[0] owns them all
};

/* Where an iris may be: the ellipse that iris and pupil fill and sclera does not (limbus/disc.h). */
struct evidence_region {
	double x, y, radius;  // middle and longer semi-axis, photo px
	double score;         // 0..1: share of iris in what is told, less where no sclera or lid lies beside it, or little of it shows
};

enum { EVIDENCE_REGIONS = 4 };

struct evidence_net;

/* Loads the network. False, err set: the file is missing, damaged or of another shape. evidence_close, which accepts null. */
bool evidence_open(struct evidence_net **net, const char *path, struct err *err);
void evidence_close(struct evidence_net *net);

/* The same of the network that comes with the programs: config/evidence.onnx. */
bool evidence_open_shipped(struct evidence_net **net, struct err *err);

/* Evidence round (cx, cy), at the scale that suits an iris of so many px radius: it becomes EVIDENCE_RADIUS px in the network's
 * input, so that the planes reach 3.2 radii to the sides, 2 up and down, with a pixel of 1/20 of the radius. The mean of what the
 * window and its mirror image say: a mirrored photograph has mirrored evidence. What lies beyond the photograph repeats its border.
 * evidence_free. */
enum { EVIDENCE_RADIUS = 40 };
bool evidence_window(struct evidence *out, struct evidence_net *net, const struct photo *photo, double cx, double cy, double radius,
                     struct err *err);

/* The same round n places at once (x, y, radius of an iris), at a glance, for films: EVIDENCE_GLANCE px radius in EVIDENCE_GLANCE_WIDE x
 * EVIDENCE_GLANCE_HIGH, a pixel of the planes 1/10 of it, the mirror image not asked. n at most EVIDENCE_GLANCES. Each out is to be freed by evidence_free. */
enum { EVIDENCE_GLANCE = 20, EVIDENCE_GLANCE_WIDE = 128, EVIDENCE_GLANCE_HIGH = 96, EVIDENCE_GLANCES = 4 };
bool evidence_glance(struct evidence out[], int n, const double place[][3], struct evidence_net *net, const struct photo *photo, struct err *err);

/* Evidence over the whole photograph, reduced (or enlarged) to long_px px on its longer side in the network's input; irises of 6 to
 * 48 px radius there are told. The planes' scale is twice the reduction. evidence_free. */
bool evidence_whole(struct evidence *out, struct evidence_net *net, const struct photo *photo, int long_px, struct err *err);

/* Candidate irises of a photograph, best first: from the whole of it at 64, 128 and 256 px and, where those show no large iris or no two
 * small ones for sure, dark spots of it at 512 px, each looked at again at scales where it suits the network. Irises of 0.5 % to 75 % of
 * the longer side in radius; both eyes of a face. *n at most EVIDENCE_REGIONS, 0 where nothing looks like an iris. */
bool evidence_find(struct evidence_region out[EVIDENCE_REGIONS], int *n, struct evidence_net *net, const struct photo *photo, struct err *err);

/* Probability of a class at (x, y) px of the photograph, bilinear, clamped to the border. */
float evidence_at(const struct evidence *evidence, enum evidence_class class, double x, double y);

/* Chance of what shows between open lids (sclera, iris, pupil, what they mirror): of pixel i of the planes; at (x, y) px of the photograph. */
float evidence_eye(const struct evidence *evidence, long i);
float evidence_eye_at(const struct evidence *evidence, double x, double y);

/* What the networks that look closer are told of a place: chances of iris or pupil, sclera, lash, reflection. */
enum { EVIDENCE_TOLD = 4 };
void evidence_told(float out[EVIDENCE_TOLD], const struct evidence *evidence, double x, double y);

void evidence_free(struct evidence *evidence);

#endif
