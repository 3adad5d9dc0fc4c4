/* cv_face: faces and their eyes in a picture by OpenCV's boosted cascades (Viola and Jones 2001; Lienhart and Maydt 2002),
 * which Debian's package opencv-data holds. They know faces seen from the front, to about 30 degrees.
 */
#ifndef BRIDGE_CV_FACE_H
#define BRIDGE_CV_FACE_H
#ifdef __cplusplus
extern "C" {
#endif
#include <stdint.h>

#include "base/err.h"

struct cv_face {
	double eye[2][2];  // px, first pixel's centre at 0.5: the middle of the person's left eye, of the right one
	double mouth[2];   // its middle; where that is to be expected, if it was not found
	bool mouth_found;
};

struct cv_face_finder;

/* False, err set: the cascades are not installed. cv_face_close. */
bool cv_face_open(struct cv_face_finder **finder, struct err *err);
void cv_face_close(struct cv_face_finder *finder);

/* At most `most` faces of a grey picture in which both eyes are found; *n of them, the largest first. turn: the picture is
 * looked at after so many quarter turns clockwise; coordinates are the picture's own. The same on any number of threads. */
bool cv_face_find(int *n, struct cv_face *faces, int most, struct cv_face_finder *finder, const uint8_t *grey, int width,
                  int height, int turn, struct err *err);

#ifdef __cplusplus
}
#endif
#endif
