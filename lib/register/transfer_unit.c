#include "register/transfer_unit.h"

#include <math.h>

#include "mesh/mesh_part.h"
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

double transfer_target_unit(const struct mesh *target, const struct mesh *subject, const struct transfer_conf *conf)
{
	struct mesh_part part, fixed;
	double center[3], best = 0, top = -1;
	mesh_part_make(&part, target, conf->least_piece, 0);
	double size = mesh_size(center, &part.mesh);
	int n = 0;
	for (int i = 0; i < UNITS; i++)
		if (size * units[i] > face_least && size * units[i] < body_most) {
			best = units[i];
			n++;
		}
	if (n > 1) {
		mesh_part_make(&fixed, subject, conf->least_piece, 0);
		for (int i = 0; i < UNITS; i++)
			if (size * units[i] > face_least && size * units[i] < body_most) {
				struct mesh scaled = in_unit(&part.mesh, units[i]);
				struct nricp_align_result pose;
				struct err none = { 0 };
				nricp_align(&pose, &scaled, &fixed.mesh, 0, &conf->align, &none);
				// Of units that fit equally well, the one that needs the least scaling.
				double fit = pose.matched - 0.05 * fabs(log(pose.scale));
				if (fit > top) {
					top = fit;
					best = units[i];
				}
				mesh_free(&(struct mesh){ .vertices = scaled.vertices });
			}
		mesh_part_free(&fixed);
	}
	mesh_part_free(&part);
	return n ? best : size > 0 ? pow(10, round(log10(face_usual / size))) : 1;
}
