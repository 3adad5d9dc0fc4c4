/* ridged: the eye that the renderer's benchmarks draw: painted fibres, their relief and a collarette, in a room with two lamps. */
#ifndef TESTS_RIDGED_H
#define TESTS_RIDGED_H
#include "draw/eye/scene.h"

struct scene_conf ridged_conf(int steps, int quadrature, int path);

/* False, having said why: not made. scene_free. */
bool ridged_scene(struct scene *scene, const struct scene_conf *conf);

/* envmap_free. */
struct envmap ridged_room(void);

#endif
