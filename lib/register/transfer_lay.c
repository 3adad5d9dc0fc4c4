#include "register/transfer_lay.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "math/vec.h"
#include "register/eyes.h"

/* The subject's face round its eyes. What lies round it (a bust, a pedestal, hair, what photographs left open) is the same whichever way up the
 * character lies; nose and brow are not. mesh_part_free. */
static struct mesh_part face_of(const struct mesh *subject, const double subject_eye[2][3], const struct transfer_conf *conf)
{
	static const double reach = 1.8;  // of the distance between the eyes: from the hairline to the mouth
	double apart[3], middle[3];
	struct mesh_part face;
	bool *leave = mem_new((size_t)subject->n_vertices + 1, sizeof *leave);
	vec_add(apart, subject_eye[0], -1, subject_eye[1]);
	vec_add(middle, subject_eye[1], 0.5, apart);
	for (int i = 0; i < subject->n_vertices; i++) {
		double d[3];
		for (int k = 0; k < 3; k++)
			d[k] = (double)subject->vertices[i][k] - middle[k];
		leave[i] = vec_norm(d) > reach * vec_norm(apart);
	}
	mesh_part_make(&face, subject, conf->least_piece, leave);
	free(leave);
	return face;
}

/* The pose that landmarks at the eyes give. Its fine share of the face, -1: none. */
static double try_order(struct nricp_landmarks *eyes, const struct mesh_part *part, const double eye[2][3], double radius, bool swapped,
                        const struct mesh *subject, const struct mesh_part *face, const double subject_eye[2][3], const struct transfer_conf *conf)
{
	struct nricp_align_result pose;
	struct err none = { 0 };
	if (!eyes_landmarks(eyes, part, eye, radius, swapped, subject, subject_eye))
		return -1;
	int rows[16], fixed[16], n = 0;
	for (int i = 0; i < eyes->n; i++)
		if (face->of[eyes->fixed[i]] >= 0) {
			rows[n] = part->of[eyes->moving[i]];
			fixed[n++] = face->of[eyes->fixed[i]];
		}
	struct nricp_landmarks own = { n, rows, fixed };
	return n >= 3 && nricp_align(&pose, &part->mesh, &face->mesh, &own, &conf->align, &none) ? pose.fine : -1;
}

/* Landmarks at both meshes' eyes, the right way up; n = 0: the eyes do not tell. weighed: out, the shapes alone did not tell the way up.
 * free((void *)out.moving). */
static struct nricp_landmarks from_eyes(bool *weighed, const struct mesh *target, const struct mesh_part *part, const struct mesh *subject,
                                        const double subject_eye[2][3], const struct transfer_conf *conf)
{
	struct nricp_landmarks eyes[2] = { 0 };
	double eye[2][3], radius, fine[2] = { -1, -1 };
	*weighed = false;
	if (!eyes_of_target(eye, &radius, target))
		return eyes[0];
	struct mesh_part face = face_of(subject, subject_eye, conf);
	for (int k = 0; k < 2; k++)
		fine[k] = try_order(&eyes[k], part, (const double(*)[3])eye, radius, k, subject, &face, subject_eye, conf);
	mesh_part_free(&face);
	int best = fine[1] > fine[0];
	if (!(fine[best] > 0)) {
		best = -1;
	} else if (!nricp_stands_out(fine[best], fine[!best], conf->align.margin)) {
		const double below[2] = { eyes_below(part, (const double(*)[3])eye, radius, false), eyes_below(part, (const double(*)[3])eye, radius, true) };
		best = eyes_upright(below, fine, conf->below_eyes, conf->nearly);
		*weighed = best >= 0;
	}
	for (int k = 0; k < 2; k++)
		if (k != best)
			free((void *)eyes[k].moving);
	return best >= 0 ? eyes[best] : (struct nricp_landmarks){ 0 };
}

bool transfer_lay(struct transfer *out, const struct mesh *target, const struct mesh_part *part, const struct mesh *subject,
                  const double (*subject_eye)[3], const struct nricp_landmarks *given, const struct transfer_conf *conf, struct err *err)
{
	struct nricp_landmarks eyes = { 0 };
	bool done = false, weighed = false;
	if (!given->n && subject_eye && !transfer_same_topology(target, subject)) {
		eyes = from_eyes(&weighed, target, part, subject, subject_eye, conf);
		struct err why = { 0 };
		done = eyes.n && transfer_run(out, target, subject, &eyes, conf, &why);
		out->weighed = done && weighed;
	}
	free((void *)eyes.moving);
	return done || transfer_run(out, target, subject, given, conf, err);
}
