#include "register/transfer_lay.h"

#include <math.h>
#include <stdlib.h>

#include "register/eyes.h"

/* The pose that landmarks at the eyes give. Its fine share, -1: none. */
static double try_order(struct nricp_landmarks *eyes, const struct mesh_part *part, const double eye[2][3], double radius, bool swapped,
                        const struct mesh *subject, const double subject_eye[2][3], const struct transfer_conf *conf)
{
	struct nricp_align_result pose;
	struct err none = { 0 };
	if (!eyes_landmarks(eyes, part, eye, radius, swapped, subject, subject_eye))
		return -1;
	int rows[16], n = eyes->n;
	for (int i = 0; i < n; i++)
		rows[i] = part->of[eyes->moving[i]];
	struct nricp_landmarks own = { n, rows, eyes->fixed };
	return nricp_align(&pose, &part->mesh, subject, &own, &conf->align, &none) ? pose.fine : -1;
}

/* Landmarks at both meshes' eyes, the right way up; n = 0: the eyes do not tell. free((void *)out.moving). */
static struct nricp_landmarks from_eyes(const struct mesh *target, const struct mesh_part *part, const struct mesh *subject,
                                        const double subject_eye[2][3], const struct transfer_conf *conf)
{
	struct nricp_landmarks eyes[2] = { 0 };
	double eye[2][3], radius, fine[2] = { -1, -1 };
	if (eyes_of_target(eye, &radius, target))
		for (int k = 0; k < 2; k++)
			fine[k] = try_order(&eyes[k], part, (const double(*)[3])eye, radius, k, subject, subject_eye, conf);
	int best = fine[1] > fine[0];
	bool known = fine[best] > 0 && nricp_stands_out(fine[best], fine[!best], conf->align.margin);
	free((void *)eyes[!best].moving);
	if (known)
		return eyes[best];
	free((void *)eyes[best].moving);
	return (struct nricp_landmarks){ 0 };
}

bool transfer_lay(struct transfer *out, const struct mesh *target, const struct mesh_part *part, const struct mesh *subject,
                  const double (*subject_eye)[3], const struct nricp_landmarks *given, const struct transfer_conf *conf, struct err *err)
{
	struct nricp_landmarks eyes = { 0 };
	bool done = false;
	if (!given->n && subject_eye && !transfer_same_topology(target, subject)) {
		eyes = from_eyes(target, part, subject, subject_eye, conf);
		struct err why = { 0 };
		done = eyes.n && transfer_run(out, target, subject, &eyes, conf, &why);
	}
	free((void *)eyes.moving);
	return done || transfer_run(out, target, subject, given, conf, err);
}
