/* film: whether the camera of a video moved round the person: only then are cameras and a mesh to be had from it.
 */
#ifndef PLAN_FILM_H
#define PLAN_FILM_H

enum film_camera { FILM_UNKNOWN, FILM_RESTS, FILM_MOVES };

/* Compares a few frames of the first second: before a camera that moves all that has texture moves, and at the left and the right border there is
 * a room that does; before one that rests a part stays, of the room or of a head on a rest. A head that moves before a plain wall is taken for what it is,
 * a camera that moves before one for a head.
 * capture  its work/.made/film keeps the answer until the file changes
 * file     relative to it
 * FILM_UNKNOWN where the file cannot be decoded: the stages that read it say why. */
enum film_camera plan_film_camera(const char *capture, const char *file);

/* How many frames its header promises, and how many of them lie in its first minute; 0, 0 where it is no video. work/.made/frames keeps the answer until the file
 * changes. */
struct film_length { double frames, minute; };
struct film_length plan_film_length(const char *capture, const char *file);

#endif
