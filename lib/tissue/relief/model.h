/* model: the photograph's colour of stroma as a function of thickness, tabulated for maps of a million texels; the darkening of hollows. */
#ifndef TISSUE_RELIEF_MODEL_H
#define TISSUE_RELIEF_MODEL_H
#include "tissue/pigment/pigment.h"

enum { RELIEF_TABLE = 512 };

struct relief_table {
	double low, step;                  // ln mm of the first entry, between entries
	float rgb[RELIEF_TABLE][3];        // as pigment_model gives it
	float light[RELIEF_TABLE], slope[RELIEF_TABLE];  // luminance, and its derivative to ln thickness
};

/* Fills the table from low to high mm. white: multiplied in; x: as pigment_solve found it. */
void relief_table_make(struct relief_table *table, double low, double high, const double white[3],
                       const double x[PIGMENT_N], const struct pigment_conf *conf);

/* kappa of relief.h: how strongly surroundings darken hollows. An empirical fit to Monte Carlo of 13 tissues at 550 nm, within
 * 0.05. It grows with absorption, and is 0 where light passes through the walls. */
double relief_kappa(const struct tissue *tissue);

/* Place of ln thickness in the table: entry (0 .. RELIEF_TABLE - 2) and fraction; clamped. */
static inline int relief_place(const struct relief_table *table, float ln_thickness, float *fraction)
{
	float at = (ln_thickness - (float)table->low) / (float)table->step;
	at = at < 0 ? 0 : at > RELIEF_TABLE - 1.001f ? RELIEF_TABLE - 1.001f : at;
	int i = (int)at;
	*fraction = at - (float)i;
	return i;
}

#endif
