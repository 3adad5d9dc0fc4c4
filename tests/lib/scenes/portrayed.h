/* portrayed: a made face with its rig, plain eyes for it and a room round it, for tests of portraits. */
#ifndef TESTS_PORTRAYED_H
#define TESTS_PORTRAYED_H
#include "draw/eye/scene.h"
#include "tests/lib/scenes/face.h"

struct portrayed {
	struct face face;
	struct rig rig;
	struct scene eye;
	struct envmap env;  // radiance 1 from above
};

/* below: radiance from there, 0..1. False: no rig can be made of it. portrayed_free either way. */
bool portrayed_make(struct portrayed *p, double below);
void portrayed_free(struct portrayed *p);

#endif
