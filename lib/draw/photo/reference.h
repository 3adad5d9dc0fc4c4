/* reference: which part of a photograph is drawn, which photograph of an eye is the reference, and what is read off that one
 * besides its light.
 */
#ifndef DRAW_PHOTO_REFERENCE_H
#define DRAW_PHOTO_REFERENCE_H
#include "draw/photo/photo.h"

/* Sets window and scale: 2.2 semi-axes of the limbus round it, as far as the photograph goes, most_px at its longest side. */
void shot_window(struct shot *shot, int most_px);

/* How well a photograph serves as reference: size of the limbus, px, times the share of it that shows, times cos² of the tilt. */
double shot_merit(const struct fit *fit);

/* Width of the limbus, mm: over which sclera turns into cornea, from the blur of the edge in the photograph (edge_sigma_px); within
 * 0.2..1.2, 0.4 where it was not measured. */
double shot_limbus_width(const struct shot *shot);

#endif
