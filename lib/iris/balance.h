/* balance: the colour of the light in a photograph of an eye, from its sclera: what a white surface looks like there.
 */
#ifndef IRIS_BALANCE_H
#define IRIS_BALANCE_H
#include "anatomy/fit.h"
#include "limbus/evidence.h"

struct balance_conf {
	double sclera[3];      // reflectance of the sclera
	double inner, outer;   // the ring looked at, in semi-axes of the limbus
	double dark;           // share of the sclera's brightest, below which it lies in shadow
	double share_min;      // least share of the ring that must be sclera
};

struct balance {
	bool found;
	double rgb[3];   // linear colour of white, as bright as the brighter half of the sclera says; 1, 1, 1 where none was found
	double sclera[3];  // linear colour of what it was measured from; 0, 0, 0 where none was found
	double share;    // of the ring about the limbus that is sclera
	double spread;   // of what it was measured from, relative, 1 sigma
};

/* From the places beside the limbus that the evidence takes for sclera, in light of any colour: their mean without shadows, clipped
 * values, and the reddest quarter (vessels, caruncle, margins of lids), over the sclera's reflectance.
 * evidence  null: none is found */
struct balance balance_sclera(const struct photo *photo, const struct fit *fit, const struct evidence *evidence, const struct balance_conf *conf);

/* White as it is where nothing is known. */
struct balance balance_none(void);

/* Correlated colour temperature of the light in K, were the photograph not balanced: 6504 where white is white. NAN far from the colours
 * of black bodies. (McCamy 1992.) */
double balance_kelvin(const double rgb[3]);

#endif
