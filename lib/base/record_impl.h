/* record_impl: what record.c and record_holds.c share. */
#ifndef BASE_RECORD_IMPL_H
#define BASE_RECORD_IMPL_H
#include "base/record.h"

#define RECORD_HASHES "work/.made/hashes"

/* Path of a file of the capture folder; an absolute one is copied. free(). */
char *record_in_capture(const char *capture, const char *rel);

/* As record_open, without a new record: the old one and the cache of hashes alone. */
struct record *record_open_old(const char *capture, const char *stage);

/* Writes JSON with sorted keys. */
bool record_save_json(const char *path, const json_t *json, struct err *err);

#endif
