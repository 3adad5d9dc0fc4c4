/* white: the colour of white in a photograph: from its sclera, or from a grey card in it. */
#ifndef TISSUE_PIGMENT_WHITE_H
#define TISSUE_PIGMENT_WHITE_H
#include "image/envmap/envmap.h"
#include "tissue/light/pale.h"

enum white_source { WHITE_CAMERA, WHITE_SCLERA, WHITE_CARD };
extern const char *const white_names[];  // "camera", "sclera", "card"

struct white {
	double rgb[3];   // of white that faces the camera in that light
	double sclera[3];  // what the sclera beside the limbus shows over that, as if it faced the camera; 0: none was measured
	double shade;      // share of the light on what faces the camera that the shading of that sclera was reckoned to leave it; 0: none was measured
	double spread;   // of the pixels it was measured from, relative, 1 sigma
	double share;    // of the ring about the limbus that is sclera
	enum white_source source;
};

struct white_conf {
	struct pale_conf pale;     // where sclera is looked for
	double sclera[3];          // reflectance of the sclera
	double share_min;          // least share of the ring that must be sclera
	double card;               // reflectance of the card
	double shade_most;         // ln by which light that is told by the sclera's shading is believed to differ between sclera and iris
};

/* From the sclera: the mean of its brighter samples, over what white of their normals shows under env, divided by its reflectance, conf->sclera.
 * samples  n of pale_find; divided and reordered
 * Returns false, out the camera's white, when there is too little sclera. */
bool white_sclera(struct white *out, struct pale samples[], int n, const struct envmap *env, const struct white_conf *conf);

/* From a disc of the photograph: x, y, radius px. Returns false, err set, when it is outside or clipped. */
bool white_card(struct white *out, const struct photo *photo, const double disc[3], const struct white_conf *conf,
                struct err *err);

/* The light between the lids over the white's own: near 1 where white is from the sclera; less where it is from a card in the open; all of a photograph's
 * exposure where the camera's own is taken. By the lightness of the sclera, conf->sclera's, of which people's differ by 12 % (1 sigma). 1 where no sclera was measured.
 * told  the light was: its shading of the sclera is known. Else it was fitted to what lids and lashes shade, too, on one side perhaps, and moves the level by at most
 *       shade_most. */
double white_level(const struct white *white, bool told, const struct white_conf *conf);

/* Sigma of its ln: people's scleras, and half of what their shading tells of the light. NAN where no sclera was measured. */
double white_level_sigma(const struct white *white, bool told);

/* Whether a is the better white: a card before sclera before none; of two from sclera, the one that shows more of it. */
bool white_better(const struct white *a, const struct white *b);

/* The camera's own white balance and exposure: (1, 1, 1). */
struct white white_camera(void);

#endif
