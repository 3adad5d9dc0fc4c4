/* painted: scenes from painted iris maps, written to files and read back as the stages' artifacts are. */
#ifndef TESTS_PAINTED_H
#define TESTS_PAINTED_H
#include "draw/eye/scene.h"

/* Colour of a point of the iris, mm; its height above the iris plane, mm. */
typedef void painted_colour(float rgb[3], double x, double y);
typedef double painted_height(double x, double y);

static const double painted_extent = 6.4;  // mm

/* size x size texels; seen to 6.2 mm; stroma 0.5 mm thick; height may be null: flat. False: err. scene_free. */
bool painted_scene(struct scene *scene, int size, const struct eye *eye, const struct scene_conf *conf,
                   painted_colour *colour, painted_height *height, double pupil, struct err *err);

#endif
