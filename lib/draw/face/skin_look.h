// skin_look: numbers of the skin's and the tear line's look that the C renderer and the interactive page's shaders share. Read
// by both compilers: only comments like this one and #define of numbers with a point.
#ifndef DRAW_FACE_SKIN_LOOK_H
#define DRAW_FACE_SKIN_LOOK_H

// Pores: slope that noise of two grains (cells in a mm, the second half as strong) gives the normal over a step (mm); blotches of
// the albedo and their cells; what the slope does to diffuse light.
#define SKIN_PORES 0.10
#define SKIN_PORES_COARSE 2.1
#define SKIN_PORES_FINE 4.7
#define SKIN_PORES_STEP 0.12
#define SKIN_GRAIN 0.035
#define SKIN_GRAIN_CELLS 1.6
#define SKIN_PORES_LIGHT 0.35
// Two Trowbridge-Reitz lobes: share and roughness of each; Schlick's reflectance of skin, head on.
#define SKIN_LOBE_WIDE 0.5
#define SKIN_ROUGH_WIDE 0.50
#define SKIN_LOBE_NARROW 0.28
#define SKIN_ROUGH_NARROW 0.34
#define SKIN_MIRROR 0.028

// Wrinkles: what of their slope is left in light that has been below the skin; over how far slopes are taken, px of their map.
#define SKIN_FOLD_DIFFUSE 0.7
#define SKIN_FOLD_STEP 0.7

// The dark under a lid's edge: how far it reaches (mm; lids are some 2 mm thick), how much light it takes there, how fast it
// fades, from which share of its reach on it ends.
#define TEAR_SHADOW_MM 0.7
#define TEAR_SHADOW 0.45
#define TEAR_SHADOW_FADE 3.0
#define TEAR_SHADOW_END 0.7
// The meniscus: from which share of its height on it thins out into the film, roughness of its mirror (its images are small),
// and what of the skin's albedo it mirrors where a lid stands before the room: skin half in shadow.
#define TEAR_END 0.75
#define TEAR_ROUGH 0.15
#define TEAR_SKIN 0.5

// The lacrimal lake: at the inner corner the meniscus is so much higher than along the lids, within so many mm (on an eyeball
// of 12 mm radius; so are the lengths below). Mean way down of diffuse light that has entered a film of index 1.336, in depths:
// 2 n^2 (1 - sqrt(1 - 1 / n^2)).
#define LAKE_RISE 1.6
#define LAKE_MM 2.2
#define LAKE_LIGHT_WAY 1.203
// The caruncle, 4 to 5 mm high and 3 to 5 mm wide: how far its middle lies from the globe's edge towards the nose; out to where
// it is all moist and where dry skin begins; mucous membrane against skin; its film's slopes, in those of pores.
#define CARUNCLE_OFF 1.7
#define CARUNCLE_MM 0.9
#define CARUNCLE_END_MM 2.2
#define CARUNCLE_RED 0.95, 0.66, 0.64
#define CARUNCLE_LOBES 4.0
// Where a caruncle stands there (rig/make/lining.c): how far it reddens skin beside it. Mucous membrane, and the pale thin edge of the plica
// over the white: how high over the globe it is as red as the first, mm.
#define CARUNCLE_BESIDE_MM 1.5
#define MUCOSA_RGB 0.56, 0.27, 0.24
#define MUCOSA_THIN_RGB 0.66, 0.46, 0.42
#define MUCOSA_THICK_MM 0.45

#endif
