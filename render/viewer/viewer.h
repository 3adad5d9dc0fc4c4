/* viewer: work/review/viewer.html, the page on which a fitted eye is turned, lit and changed live. The same model as
 * draw/eye/scene.h, as WebGL 2 shaders (render/viewer); its numbers and maps come from the scene of the C renderer. */
#ifndef RENDER_VIEWER_VIEWER_H
#define RENDER_VIEWER_VIEWER_H
#include <jansson.h>

#include "render/face/skin.h"

/* One eye and what is known of it. */
struct viewer_source {
	const struct scene *scene;       // scene_fit_colour has been called
	const char *side;                // "left", "right", "eye"
	const char *pigment;             // path of pigment.json, or null
	const struct envmap *studio;
	double gain;                     // exposure
	const struct shot *shot;         // the photograph its colours are of, decoded; null: none
	const char *edge;                // path of what limbus measured in it (limbus/record.h), or null
	int lights, directions;          // beams, and directions in each
};

/* Everything the page needs of one eye. json_decref. */
json_t *viewer_eye(const struct viewer_source *source, struct err *err);

/* Maps as pictures in base 64, {png, width, height, low, high}: 8 bits a channel and what 0 and 255 mean.
 * viewer_map_log: colours by their logarithm, none below dark (> 0); viewer_map_model: the same of the model at the levels that
 * are marched from, one below the other, {from, tops} the first of them and their rows; viewer_map_plain: its first channels, at
 * most 3; viewer_map_folds: of wrinkle maps the n in `of`, one below the other. */
json_t *viewer_map_relief(const struct scene_level *level, struct err *err);
json_t *viewer_map_colour(const struct scene_level *level, struct err *err);
json_t *viewer_map_log(const float *px, int width, int height, int stride, float dark, struct err *err);
json_t *viewer_map_model(const struct scene *scene, struct err *err);
json_t *viewer_map_folds(const struct image *map, int n, const int of[], struct err *err);
json_t *viewer_map_plain(const struct image *map, struct err *err);

/* An environment: its two maps for reflections, its lights, its irradiance. mirror: what the cornea mirrors. */
json_t *viewer_light(const char *name, const struct envmap *env, const struct envmap *mirror, const struct viewer_source *source, struct err *err);

/* The tissue as fitted, with what each wavelength absorbs and scatters, and sigmas of the fit. */
json_t *viewer_tissue(const struct viewer_source *source);

/* Writes the page where it is not fresh: the photographed eyes, and the first character that has a rig, whose eyes are plain
 * ones where none was photographed. Neither: no page. */
bool viewer_make(struct skin_job *skin, struct err *err);

#endif
