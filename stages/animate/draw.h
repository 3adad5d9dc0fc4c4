/* draw: the curves of an animation, for people to look at. */
#ifndef DRAW_H
#define DRAW_H
#include "motion/animate.h"

/* Gaze, speed, lids and expressions over time, the saccades' main sequence: SVG. */
bool draw_animation(const char *path, const struct animation *animation, const struct skin_model *model,
                    const struct animate_conf *conf, const char *made_by, struct err *err);

#endif
