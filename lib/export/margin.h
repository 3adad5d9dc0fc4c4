/* margin: what stands on a character's lids round an eye that leaves alone: lashes, and the meniscus of tears on the lower lid. */
#ifndef EXPORT_MARGIN_H
#define EXPORT_MARGIN_H
#include "export/part.h"
#include "rig/hair/hair.h"

enum export_margin_name { EXPORT_LASHES, EXPORT_TEARS, EXPORT_MARGIN_PARTS };
extern const char *const export_margin_names[EXPORT_MARGIN_PARTS];

/* At rest, as the lids of that side (0 left, 1 right) hold them, scaled as the eye is to the character's globe.
 * margin  overwritten, without texture coordinates; n_corners = 0 where there are none; export_part_free each
 * tear_mm  of the character; over_mm: that the eye stands over its globe */
void export_margin(struct export_part margin[EXPORT_MARGIN_PARTS], const struct scene *eye, const struct rig *rig, const struct hairs *hairs, int side,
                   double tear_mm, double over_mm);

#endif
