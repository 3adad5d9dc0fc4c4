#ifndef STAGES_PIGMENT_STAGE_H
#define STAGES_PIGMENT_STAGE_H
#include "anatomy/capture.h"
#include "anatomy/eye.h"
#include "tissue/pigment/white.h"
#include "tissue/pigment/white_pair.h"
#include "tissue/pigment/melanin.h"
#include "tissue/pigment/pigment.h"

extern const char *const pigment_orders[], *const pigment_whites[];  // "single", "multiple"; in the order of WHITE_FROM
extern const char *const pigment_melanins[];  // in the order of MELANIN
enum { MELANIN_ONE, MELANIN_MAP };
enum { PIGMENT_MAP_LIMIT_PX = 1 << 26 };
enum { WHITE_FROM_SCLERA, WHITE_FROM_CARD, WHITE_FROM_CAMERA };

struct pigment_stage_conf {
	struct pigment_conf fit;
	struct pigment_classes_conf classes;
	int melanin;            // MELANIN_...
	double melanin_ring;    // fit.melanin_ring where it is a map
	struct melanin_conf map;
	struct white_conf white;
	struct white_pair_conf fellow;
	double prior_exposure[2], prior_exposure_single[2];  // median, sigma of ln
	double prior_white, prior_veil;                      // sigmas
	double prior_melanin[2][2], prior_ratio[2][2], prior_scale[2], prior_spread[2];
	double pupil_radius;    // mm, where none was found
	double root_beyond_limbus;
	double limit_mpx;
	double white_unknown;   // sigma of ln exposure where no white was seen
	double white_doubt;     // ln: errors of the white as fitted that are smaller are the model's
	int white_from;         // WHITE_FROM_..., the best there is
	int order, illuminant;  // of scattering: 0 first, 1 all
	double light_unknown;   // the same where the light was not told
	const char *light;      // light.environment, or null
	struct opt_each_list card;
};

/* Sets the priors from the options; checks what ranges cannot. Returns false, err set. */
bool pigment_stage_check(struct pigment_stage_conf *conf, struct err *err);

/* One eye of the folder: reads its maps and photographs, writes pigment.json, unless that is fresh. */
bool pigment_stage(struct stage *stage, const struct capture *capture, int eye, const struct eye *anatomy,
                   const struct pigment_stage_conf *conf, struct err *err);

#endif
