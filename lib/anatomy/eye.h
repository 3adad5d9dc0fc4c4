/* eye: the eye's dimensions, which all stages share: the `eye.*` keys. Eye frame: origin at the corneal apex, z into the eye; mm.
 * */
#ifndef ANATOMY_EYE_H
#define ANATOMY_EYE_H
#include "base/opt.h"
#include "optics/camera.h"
#include "optics/cornea/cornea.h"

struct eye {
	double cornea_radius, cornea_asphericity, index;  // R mm, p, n
	double limbus_radius;    // mm, horizontal
	double limbus_aspect;    // vertical / horizontal; NAN: unknown, the anatomical prior holds
	double iris_depth;       // mm behind the apex
	bool two_surface;
	double post_radius, post_asphericity, thickness, cornea_index;  // of the posterior surface, mm; read if two_surface
};

/* Rows for a stage's option table; the first for one that needs no more of the eye. */
#define EYE_LIMBUS_RADIUS_OPT(radius) OPT_REAL("eye.limbus_radius_mm", radius, 4, 8, "mm", "half the horizontal visible iris diameter")
#define EYE_OPTS(e) \
	OPT_REAL("eye.cornea_radius_mm", &(e)->cornea_radius, 5, 12, "mm", "apical radius R of the cornea"), \
	OPT_REAL("eye.cornea_asphericity", &(e)->cornea_asphericity, 0, 2, "", "asphericity p of the cornea"), \
	OPT_REAL("eye.index", &(e)->index, 1, 2, "", "index of the aqueous; behind the one-surface cornea"), \
	EYE_LIMBUS_RADIUS_OPT(&(e)->limbus_radius), \
	OPT_REAL_UNSET("eye.limbus_aspect", &(e)->limbus_aspect, 0.7, 1.2, "", "vertical / horizontal; 1 declares a circle; unset: the anatomical prior"), \
	OPT_REAL("eye.iris_depth_mm", &(e)->iris_depth, 1.5, 6, "mm", "iris plane behind the apex"), \
	OPT_BOOL("eye.two_surface", &(e)->two_surface, "model the posterior surface of the cornea too"), \
	OPT_REAL("eye.posterior_radius_mm", &(e)->post_radius, 4, 12, "mm", "apical radius of the posterior surface"), \
	OPT_REAL("eye.posterior_asphericity", &(e)->post_asphericity, 0, 2, "", "asphericity of the posterior surface"), \
	OPT_REAL("eye.cornea_thickness_mm", &(e)->thickness, 0.2, 1.2, "mm", "central thickness of the cornea"), \
	OPT_REAL("eye.cornea_index", &(e)->cornea_index, 1, 2, "", "index of the cornea, two-surface model")

/* Checks what ranges of single keys cannot: that the limbus lies on the cornea and the iris behind it. Returns false, err set
 * (key, value, rule), otherwise. */
bool eye_check(const struct eye *eye, struct err *err);

/* The cornea of the eye (optics/cornea/cornea.h). */
struct cornea eye_cornea(const struct eye *eye);

/* Depth of the limbus plane behind the apex, mm. */
double eye_limbus_depth(const struct eye *eye);

#endif
