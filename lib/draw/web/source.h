/* source: one eye for the interactive page, and what is known of it. Everything is borrowed. */
#ifndef DRAW_WEB_SOURCE_H
#define DRAW_WEB_SOURCE_H
#include "draw/photo/photo.h"

struct web_source {
	const struct scene *scene;       // scene_fit_colour has been called
	const char *side;                // "left", "right", "eye"
	const char *pigment;             // path of pigment.json, or null
	const struct envmap *studio;
	double gain;                     // exposure
	const struct shot *shot;         // the photograph its colours are of, decoded; null: none
	const char *edge;                // path of what limbus measured in it (limbus/record.h), or null
	int lights, directions;          // beams, and directions in each
};

#endif
