#include "register/transfer_lay.h"

#include <stdlib.h>

#include "register/eyes.h"

bool transfer_lay(struct transfer *out, const struct mesh *target, const struct mesh_part *part, const struct mesh *subject,
                  const double (*subject_eye)[3], const struct nricp_landmarks *given, const struct transfer_conf *conf, struct err *err)
{
	struct nricp_landmarks eyes = { 0 };
	double eye[2][3], radius;
	bool done = false;
	if (!given->n && subject_eye && eyes_of_target(eye, &radius, target)
	    && eyes_landmarks(&eyes, part, (const double(*)[3])eye, radius, subject, subject_eye)) {
		struct err why = { 0 };
		done = transfer_run(out, target, subject, &eyes, conf, &why);
	}
	free((void *)eyes.moving);
	return done || transfer_run(out, target, subject, given, conf, err);
}
