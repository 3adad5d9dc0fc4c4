/* film: whether the camera of a video moved round the person: only then are cameras and a mesh to be had from it.
 */
#ifndef PLAN_FILM_H
#define PLAN_FILM_H

enum film_camera { FILM_UNKNOWN, FILM_RESTS, FILM_MOVES };

/* Compares a few frames of the first second: a camera that moves moves all that has texture along the picture's border, beside the person, on all
 * four sides. Where a side shows nothing, or part of it stays, the camera is taken to rest.
 * capture  its work/.made/film keeps the answer until the file changes
 * file     relative to it
 * FILM_UNKNOWN where the file cannot be decoded: the stages that read it say why. */
enum film_camera plan_film_camera(const char *capture, const char *file);

#endif
