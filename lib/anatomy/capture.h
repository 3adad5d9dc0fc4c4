/* capture: the photographs of a capture folder, grouped by eye.
 * The side of a photograph is that of photo.NAME.eye (left, right), else of the beginning of its name (left_, right_), else "eye".
 * Of the eyes in the folder, the first in the order eye, left, right has its maps in work/iris/, the others in work/iris_SIDE/.
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
	const char *leaves;  // "work/export" or "work/export_right": what other programs read
};

struct capture {
	struct capture_photo *photos;
	int n_photos;
	struct capture_eye eyes[3];
	int n_eyes;
};

/* Rows for the option table: photo.*.eye. */
#define CAPTURE_OPTS(each_eye) OPT_EACH("photo.*.eye", each_eye, 0, 0, 0, "", "left or right, where the name does not say")

/* Lists the files of photos/, recorded as an input of the stage. Of two files of one NAME, the second is left out with a warning.
 * eye_of: the values of photo.*.eye. capture_free. Returns false, err set, when there is no photograph or a key names a file that
 * is not there. */
bool capture_load(struct capture *capture, struct stage *stage, const struct opt_each_list *eye_of, struct err *err);
void capture_free(struct capture *capture);

/* The value given for photograph NAME in a list of matches, or null; owned by the list. */
const struct opt_each *capture_each(const struct opt_each_list *list, const char *name);

#endif
