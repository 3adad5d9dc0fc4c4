/* capture: the photographs of a folder, grouped by eye.
 * Side: photo.NAME.eye (left, right), else the name's beginning (left_, right_), else "eye".
 * One eye in the folder: its maps are in work/iris/. Several: the first in the order eye, left, right is in
 * work/iris/, the others in work/iris_SIDE/.
 */
#ifndef ANATOMY_CAPTURE_H
#define ANATOMY_CAPTURE_H
#include "base/stage.h"

struct capture_photo {
	char *name;   // without extension: NAME of limbus/NAME.json
	char *file;   // "photos/left_a.jpg"
	char *fit;    // "work/limbus/left_a.json"
	int eye;      // index into eyes[]
};

struct capture_eye {
	const char *side;  // "eye", "left", "right"
	const char *iris;  // "work/iris" or "work/iris_right"; artifacts are IRIS/texture.exr ...
	const char *render;  // "work/render" or "work/render_right"
};

struct capture {
	struct capture_photo *photos;
	int n_photos;
	struct capture_eye eyes[3];
	int n_eyes;
};

/* Rows for the option table: photo.*.eye. */
#define CAPTURE_OPTS(each_eye) OPT_EACH("photo.*.eye", each_eye, 0, 0, 0, "", "left or right, where the name does not say")

/* All files of photos/. Two files of one NAME: the second is left out with a warning. */
bool capture_load(struct capture *capture, struct stage *stage, const struct opt_each_list *eye_of, struct err *err);
void capture_free(struct capture *capture);

/* The value given for photo NAME, or null. */
const struct opt_each *capture_each(const struct opt_each_list *list, const char *name);

#endif
