/* unrefract: the stage's files: the photographs of one eye in, its texture out. The algorithm is in lib/iris/unrefract. */
#ifndef STAGES_UNREFRACT_H
#define STAGES_UNREFRACT_H
#include "anatomy/capture.h"
#include "iris/unrefract/unrefract.h"

struct run {
	struct stage *stage;
	const struct capture *capture;
	const struct eye *eye;
	const struct unrefract_conf *conf;
	const struct balance_conf *white;
	double limit_mpx;
	bool write_map;
};

/* Makes texture.exr and texture.json of eye `index` of the capture, unless they are up to date. An eye without a usable photograph is left
 * out where another has one. False, err set, when none has or a file cannot be written. */
bool unrefract_eye(const struct run *run, int index, struct err *err);

/* Writes IRIS/NAME.map.exr: the iris-plane point that each photo pixel sees (lib/README.md). */
bool unrefract_write_map(const struct run *run, const struct capture_photo *photo, const struct unrefract_view *view,
                         const char *iris, struct err *err);

#endif
