/* asked: the files of the capture that a stage has looked for in vain. What it makes depends on them as on those that it found: once one
 * of them is there the stage has to run again. A file that is there and cannot be read (a disk that fails) is neither: what was made without
 * it counts as not made.
 */
#ifndef BASE_ASKED_H
#define BASE_ASKED_H
#include <stdbool.h>

/* From now on files below this folder are noted. Once in a program. */
void asked_watch(const char *folder);

/* A file could not be opened or looked at; why: errno. Any thread. */
void asked_in_vain(const char *path, int why);

/* Calls f with the path inside the folder of each file that was not there when it was asked for, and is not now; sorted, each once. */
void asked_absent(void (*f)(void *ctx, const char *rel), void *ctx);

/* The first file that the disk has failed to give, for as long as the program runs; null: none. */
const char *asked_trouble(void);

#endif
