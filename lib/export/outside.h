/* outside: the outer surface of the eye, cornea and sclera in one: what the renderer traces (draw/eye/exact/trace.c). Frame: eye, mm. */
#ifndef EXPORT_OUTSIDE_H
#define EXPORT_OUTSIDE_H
#include "draw/eye/scene.h"

/* Distance from the axis in units of the limbus, which may be an ellipse: 1 on the limbus. */
double export_rho(const struct scene *scene, double x, double y);

/* The point of the front half above (x, y): whichever of the cornea's conic and the scleral sphere stands further out. */
void export_front(double at[3], const struct scene *scene, double x, double y);

/* The unit normal there, out of the eye: the cornea's turns into the sphere's over the sulcus, as in pictures. */
void export_normal(double normal[3], const struct scene *scene, const double at[3]);

/* Share of sclera over cornea there, 0 inside the limbus to 1 outside. */
double export_white(const struct scene *scene, double rho);

/* rho at which nothing of the iris shows any more: there the cornea's mesh ends and the sclera's begins. */
double export_seam(const struct scene *scene);

#endif
