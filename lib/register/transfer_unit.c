#include "register/transfer_unit.h"

#include <math.h>
#include <stdlib.h>

#include "math/vec.h"
#include "mesh/mesh_part.h"
#include "register/eyes.h"
#include "register/nricp/frame.h"

/* Sizes (mesh_size), mm: the least and the largest of the skin of a face or a head, from a patch round the eyes to a giant's bust;
 * the usual one; the largest of a whole body. */
static const double face_least = 30, face_most = 250, face_usual = 85, body_most = 1100;
static const double units[] = { 1, 10, 100, 1000 };
enum { UNITS = sizeof units / sizeof *units };

/* Distance from the usual size, by ratio. */
static double off(double size)
{
	return fabs(log(size / face_usual));
}

double transfer_subject_unit(const struct mesh *subject)
{
	double center[3], size = mesh_size(center, subject), best = 1;
	if (!(size > 0))
		return 1;
	for (int i = 0; i < UNITS; i++)
		if (off(size * units[i]) < off(size * best))
			best = units[i];
	// None of the usual units fits: a power of ten.
	return size * best > face_least && size * best < face_most ? best : pow(10, round(log10(face_usual / size)));
}

static struct mesh in_unit(const struct mesh *mesh, double unit)
{
	double to_mm[4][4] = { { unit, 0, 0, 0 }, { 0, unit, 0, 0 }, { 0, 0, unit, 0 }, { 0, 0, 0, 1 } }, origin[3] = { 0 };
	return nricp_carried(mesh, to_mm, origin, 1);
}

/* The usual unit within a factor of 2 of this one; else itself. */
static double usual_near(double unit)
{
	for (int i = 0; i < UNITS; i++)
		if (fabs(log(unit / units[i])) < log(2))
			return units[i];
	return unit;
}

/* How well it aligns in that unit; a pose that does not stand out counts half. */
static double fit_in(double unit, const struct mesh *part, const struct mesh *subject, const struct nricp_align_conf *conf)
{
	struct mesh scaled = in_unit(part, unit);
	struct nricp_align_result pose;
	struct err none = { 0 };
	bool known = nricp_align(&pose, &scaled, subject, 0, conf, &none);
	free(scaled.vertices);
	return known ? pose.fine : 0.5 * pose.fine;
}

/* Tries the unit of its size; where that does not fit well, places all over it, the very size, and the units in which it may be a body. */
static double by_fit(const struct mesh *part, double size, const struct mesh *subject, double subject_size,
                     const struct nricp_align_conf *conf)
{
	static const double sure = 0.6;
	double own = subject_size / size, tries[UNITS + 2] = { usual_near(own), own }, best = tries[0];
	int n = own == tries[0] ? 1 : 2;
	for (int i = 0; i < UNITS; i++)
		if (size * units[i] > face_least && size * units[i] < body_most && units[i] != tries[0])
			tries[n++] = units[i];
	struct nricp_align_conf quick = *conf;
	quick.starts = 0;
	double top = fit_in(best, part, subject, &quick);
	for (int i = 0; i < n && top < sure; i++) {
		double fit = fit_in(tries[i], part, subject, conf);
		if (fit > top) {
			top = fit;
			best = tries[i];
		}
	}
	return best;
}

double transfer_target_unit(const struct mesh *target, const struct mesh *subject, const double (*subject_eye)[3],
                            const struct transfer_conf *conf)
{
	double eye[2][3], radius, apart[3], own[3], center[3], unit = 1;
	if (subject_eye && eyes_of_target(eye, &radius, target)) {
		vec_add(apart, subject_eye[0], -1, subject_eye[1]);
		vec_add(own, eye[0], -1, eye[1]);
		return usual_near(vec_norm(apart) / vec_norm(own));
	}
	struct mesh_part part, fixed;
	mesh_part_make(&part, target, conf->least_piece, 0);
	mesh_part_make(&fixed, subject, conf->least_piece, 0);
	double size = mesh_size(center, &part.mesh), subject_size = mesh_size(center, &fixed.mesh);
	if (size > 0 && subject_size > 0)
		unit = by_fit(&part.mesh, size, &fixed.mesh, subject_size, &conf->align);
	mesh_part_free(&part);
	mesh_part_free(&fixed);
	return unit;
}
