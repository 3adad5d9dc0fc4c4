/* cv_face: faces and their eyes in a picture by OpenCV's boosted cascades (Viola and Jones 2001; Lienhart and Maydt 2002),
 * which are in Debian's package opencv-data. They detect faces seen from the front, up to about 30 degrees.
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
	double mouth[2];   // px, its middle; where it is not found, the position expected from the eyes
	bool mouth_found;
};

struct cv_face_finder;

/* Loads the cascades: *finder, cv_face_close. Returns false, err set, when they are not installed. */
bool cv_face_open(struct cv_face_finder **finder, struct err *err);
void cv_face_close(struct cv_face_finder *finder);

/* Finds faces with both eyes in a picture.
 * faces  [most] out, the largest first; *n of them
 * grey   [height][width]
 * turn   quarter turns clockwise after which the picture is upright; coordinates are those of the picture as given
 * Returns false, err set, where OpenCV fails. The same result on any number of threads. */
bool cv_face_find(int *n, struct cv_face *faces, int most, struct cv_face_finder *finder, const uint8_t *grey, int width,
                  int height, int turn, struct err *err);

#ifdef __cplusplus
}
#endif
#endif
