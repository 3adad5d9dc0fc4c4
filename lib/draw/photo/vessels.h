/* vessels: the vessels of the white of the eye that a photograph shows. */
#ifndef DRAW_PHOTO_VESSELS_H
#define DRAW_PHOTO_VESSELS_H
#include "draw/photo/photo.h"

/* A map of the scleral sphere, as those of draw/eye/sclera.h, of two channels: share of a texel that vessels of the conjunctiva cover; 1 where the photograph shows the
 * white, falling to 0 towards lids, limbus and what is turned away. A vessel is redder than the white round it by more than the noise, over a length: lashes, shadows and
 * reflections are not.
 * shot           decoded, with the evidence that tells its white; eye: its cornea and limbus
 * sclera_radius  mm
 * size           texels across
 * False, seen empty, where no evidence is told, or where a hundredth of the map or less shows white. image_free. */
bool vessels_of_photo(struct image *seen, const struct shot *shot, const struct eye *eye, double sclera_radius, int size);

#endif
