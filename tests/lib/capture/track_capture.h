/* track_capture: a rendered clip of data/video as a capture, with the keys that a person who films could give (lens, mesh, landmarks), and the stage `track` run on it. */
#ifndef TESTS_TRACK_CAPTURE_H
#define TESTS_TRACK_CAPTURE_H
#include <stdbool.h>

/* dir: is made. how: of worsen.h, or null: the clip as it is. units: n action units whose frames are marked, in review. */
bool track_capture_make(const char *dir, const char *clip, const char *quality, const char *how, int n, const char *const units[]);

/* Of any folder of a clip with its truth (video.mp4, subject.ply, truth.json): nothing but the camera, the mesh, its unit and the landmarks
 * of the lids; centers: the eyeballs' centres and radius, too. */
bool track_capture_bare(const char *dir, const char *from, const char *quality, bool centers);

/* Seconds bin/track took; NAN when it failed. */
double track_capture_run(const char *dir);

/* Names of the folders of $EYEWRIGHT_FACES that hold a clip (video.mp4), in order, of those whose name has $FACES in it where that is set; free() each. Returns how many, at most
 * TRACK_FACES. */
enum { TRACK_FACES = 256 };
int track_capture_faces(char *name[TRACK_FACES]);

#endif
