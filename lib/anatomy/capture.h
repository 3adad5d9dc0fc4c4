/* capture: the photographs of a capture folder, grouped by eye.
 * The side of a photograph is that of photo.NAME.eye (left, right), else of the beginning of its name (left_, right_), else "eye".
 * A photograph in which limbus has found both eyes of a face counts as two, NAME.left and NAME.right, one of each eye.
 * Of the eyes in the folder, the first in the order eye, left, right has its maps in work/iris/, the others in work/iris_SIDE/.
 */
#ifndef ANATOMY_CAPTURE_H
#define ANATOMY_CAPTURE_H
#include "base/stage.h"

struct capture_photo {
	char *name;   // without extension: NAME of limbus/NAME.json; with .left or .right where the file shows both eyes
	char *whole;  // the same without that
	char *file;   // "photos/left_a.jpg"
	char *fit;    // "work/limbus/left_a.json"
	int eye;      // index into eyes[]
	bool part;    // one of the two eyes that the file shows
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

/* The same before limbus has run: every file is one photograph. */
bool capture_list(struct capture *capture, struct stage *stage, const struct opt_each_list *eye_of, struct err *err);

/* Whether photograph i may count as two: no side is said of it, and no file has the name of a part. */
bool capture_may_part(const struct capture *capture, int i);

/* Photograph i becomes two, the left eye's and behind it the right one's. eyes[] and the photographs' numbers of eyes are made anew. */
void capture_part(struct capture *capture, int i);

/* The other eye of a photograph of a face, in capture->photos; null: there is none. */
const struct capture_photo *capture_fellow(const struct capture *capture, const struct capture_photo *photo);

/* The value given for a photograph in a list of matches, of a part else the whole's, or null; owned by the list. */
const struct opt_each *capture_key(const struct opt_each_list *list, const struct capture_photo *photo);

/* The value given for photograph NAME in a list of matches, or null; owned by the list. */
const struct opt_each *capture_each(const struct opt_each_list *list, const char *name);

#endif
