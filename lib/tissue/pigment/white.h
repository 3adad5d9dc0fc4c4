/* white: the colour of white in a photograph: from its sclera, or from a grey card in it. */
#ifndef TISSUE_PIGMENT_WHITE_H
#define TISSUE_PIGMENT_WHITE_H
#include "anatomy/fit.h"
#include "image/photo/photo.h"

enum white_source { WHITE_CAMERA, WHITE_SCLERA, WHITE_CARD };
extern const char *const white_names[];  // "camera", "sclera", "card"

struct white {
	double rgb[3];   // of a white Lambertian surface in that light
	double spread;   // of the pixels it was measured from, relative, 1 sigma
	double share;    // of the ring about the limbus that is sclera
	enum white_source source;
};

struct white_conf {
	double sclera[3];          // reflectance of the sclera
	double inner, outer;       // the ring, in semi-axes of the limbus
	double redness;            // ln R/G above the palest samples, from which on it is skin
	double reddest;            // ln R/G from which on it is skin in any case
	double dark;               // share of the ring's brightest, below which it is shadow
	double share_min;          // least share of the ring that must be sclera
	double card;               // reflectance of the card
};

/* From the ring outside the limbus: the mean of pale, bright samples that are not clipped, divided by the sclera's reflectance.
 * Returns false, out the camera's white, when there is too little sclera. */
bool white_sclera(struct white *out, const struct photo *photo, const struct fit *fit, const struct white_conf *conf);

/* From a disc of the photograph: x, y, radius px. Returns false, err set, when it is outside or clipped. */
bool white_card(struct white *out, const struct photo *photo, const double disc[3], const struct white_conf *conf,
                struct err *err);

/* Whether a is the better white: a card before sclera before none; of two from sclera, the one that shows more of it. */
bool white_better(const struct white *a, const struct white *b);

/* The camera's own white balance and exposure: (1, 1, 1). */
struct white white_camera(void);

#endif
