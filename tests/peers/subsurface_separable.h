/* subsurface_separable: the separable kernel that subsurface_spread() is compared with. */
#ifndef TESTS_SUBSURFACE_SEPARABLE_H
#define TESTS_SUBSURFACE_SEPARABLE_H
#include "image/subsurface/subsurface.h"

/* Jimenez et al. 2015: one separable kernel of `taps` samples (odd, at most 65), denser towards the middle, the profile
 * integrated over one direction ("pre-integrated"), with depth weights. What subsurface_spread() is compared with. */
void subsurface_separable(const struct subsurface_picture *picture, const struct subsurface_profile *profile, int taps, struct subsurface_room *room);

#endif
