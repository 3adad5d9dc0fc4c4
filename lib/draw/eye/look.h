// scene_look: numbers of the eye's look that the C renderer and the interactive page's shaders share. Read by both
// compilers: only comments like this one and #define of numbers with a point; a list is a colour, red green blue.
#ifndef DRAW_EYE_LOOK_H
#define DRAW_EYE_LOOK_H

// Index of the tear film, which mirrors on all wet surfaces.
#define LOOK_FILM_INDEX 1.336
// The corneal normal turns into the sphere's between these shares of the limbus: no crease stands where they meet.
#define LOOK_SEAM_FROM 0.90
#define LOOK_SEAM_TO 1.12
// The film is smooth on the cornea, and lies on a rough ground beyond the limbus: how rough, and from where to where.
#define LOOK_FILM_ROUGH 0.75
#define LOOK_FILM_FROM 1.0
#define LOOK_FILM_TO 1.35
// Next to the limbus the sclera thins out over the dark of the chamber's angle: how much darker, and from where to where.
#define LOOK_RIM_DARK 0.36, 0.31, 0.25
#define LOOK_RIM_FROM 0.97
#define LOOK_RIM_TO 1.22
// The pupil's ruff: height of its ridges, width, and what it adds with a ridge, softness, half the margin's blur, mm; what its
// pigment leaves of the colour, and how much of it there is.
#define LOOK_RUFF_RIDGE 0.018
#define LOOK_RUFF_WIDTH 0.045
#define LOOK_RUFF_MORE 0.02
#define LOOK_RUFF_SOFT 0.05
#define LOOK_RUFF_BLUR 0.012
#define LOOK_RUFF_COLOUR 0.30, 0.20, 0.15
#define LOOK_RUFF_SHARE 0.75
// Shadow of the relief: width of every source (slope), what tissue around in the light fills in, a surface's distance from
// itself (mm).
#define LOOK_SOURCE 0.15
#define LOOK_FILL 0.4
#define LOOK_BIAS 0.004
// Of light that spreads in the tissue: what is darker than that, white facing the light being 1, is left as it is.
#define LOOK_BESIDE_DARK 0.002
// A ray of sight that leans more than that to the iris' axis may cross the relief several times.
#define LOOK_LEANS 0.3
// The march's quadrature: ways of light to and fro through a cornea, over the depth (about 1.05 and 1.3 times it).
#define LOOK_WAYS 2.35
// Light off the lids on the eye below them.
#define LOOK_BOUNCE 0.34, 0.25, 0.20

#endif
