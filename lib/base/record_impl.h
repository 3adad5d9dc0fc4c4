/* record_impl: what record.c and record_holds.c share; nobody else includes this. */
#ifndef BASE_RECORD_IMPL_H
#define BASE_RECORD_IMPL_H
#include "base/record.h"

#define RECORD_HASHES "work/.made/hashes"

/* The path of a file of the capture folder; an absolute one stays. free(). */
char *record_in_capture(const char *capture, const char *rel);

/* With the old record and the hashes alone: nothing new is begun. */
struct record *record_open_old(const char *capture, const char *stage);

bool record_save_json(const char *path, const json_t *json, struct err *err);

#endif
