/* One eye's photographs into its texture. */
#ifndef STAGES_UNREFRACT_H
#define STAGES_UNREFRACT_H
#include "anatomy/capture.h"
#include "iris/unrefract/unrefract.h"

struct run {
	struct stage *stage;
	const struct capture *capture;
	const struct eye *eye;
	const struct unrefract_conf *conf;
	double limit_mpx;
	bool write_map;
};

/* False, err set, when no photograph of that eye can be used. */
bool unrefract_eye(const struct run *run, int index, struct err *err);

/* IRIS/NAME.map.exr */
bool unrefract_write_map(const struct run *run, const struct capture_photo *photo, const struct unrefract_view *view,
                         const char *iris, struct err *err);

#endif
