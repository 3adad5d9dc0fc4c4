/* pale: samples of the sclera in a photograph, beside the limbus. */
#ifndef TISSUE_LIGHT_PALE_H
#define TISSUE_LIGHT_PALE_H
#include "anatomy/fit.h"
#include "image/photo/photo.h"
#include "limbus/evidence.h"

enum { PALE_AROUND = 180, PALE_ACROSS = 10, PALE_MAX = PALE_AROUND * PALE_ACROSS };

/* Radius of the scleral sphere, mm: adults 11 to 12.5. A change by one moves the sclera's shading by 2 %. */
#define PALE_SCLERA_MM 11.8

struct pale_conf {
	double inner, outer;       // the ring searched, in semi-axes of the limbus
	double redness;            // ln R/G above the palest samples, from which on it is skin
	double reddest;            // ln R/G from which on it is skin in any case
	double dark;               // share of the ring's brightest, below which it is shadow
	double white;              // ln R/G of white in this photograph, as far as it is known: in tungsten light sclera is as red as skin
	double sure;               // evidence from which a place counts as sclera
};

struct pale {
	float rgb[3], light, redness;  // linear; luminance; ln R/G
	float shown;                   // luminance as photographed, whatever rgb and light were divided by since
	float normal[3];               // of the sclera there, in the camera's frame
};

/* Sclera is the palest bright surface beside an iris, of what the evidence takes for sclera: skin is redder, lashes and folds are darker. Clipped samples are left out.
 * Reads the limbus from the fit, and the pose where its camera is known: else normals face the camera.
 * out       [PALE_MAX]
 * evidence  null: by colour alone, to which skin in a cold light is sclera
 * Returns how many of PALE_MAX places show sclera. */
int pale_find(struct pale out[PALE_MAX], const struct photo *photo, const struct fit *fit, const struct eye *eye, const struct evidence *evidence,
              const struct pale_conf *conf);

#endif
