/* find_white: the white that an eye's colours are measured against, from its photographs. */
#ifndef STAGES_PIGMENT_FIND_WHITE_H
#define STAGES_PIGMENT_FIND_WHITE_H
#include "stages/pigment/pigment_stage.h"
#include "tissue/light/sclera_light.h"

struct found_white {
	struct white white;    // in the texture's colours
	bool joined;           // its colour is that beside the other eye, too
	const char *photo;     // NAME of the photograph it is from; null: none
	double cos_view;       // mean cosine, behind the cornea, of the directions that the photographs see the iris from
	struct image light;    // mean of iris_light_make over the photographs, over the maps' square; image_free
	struct image slant;    // their sums of its slant; image_free
	struct found_light { const char *photo; struct sclera_light shading; } *lights;  // of every photograph looked at, where the light is not told; free
	int n_lights;
};

/* Reads every photograph of the eye that the texture was made of. One that cannot be read is warned of and left out.
 * A face's white is that of both eyes (white_pair).
 * env     the photographs' own light, of level 1; null: each photograph's, by the shading of its sclera
 * extent  half-width of the maps, mm
 * Returns false, err set, when the texture's record cannot be read. */
bool find_white(struct found_white *out, struct stage *stage, const struct capture *capture, int eye, const struct eye *anatomy,
                const struct envmap *env, double extent, const struct pigment_stage_conf *conf, struct err *err);

#endif
