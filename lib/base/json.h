/* json: reading JSON files of our own with errors that name file, key and rule; writing them atomically. */
#ifndef BASE_JSON_H
#define BASE_JSON_H
#include <jansson.h>

#include "base/err.h"

/* A JSON object; at most `limit` bytes. json_decref. Null, err set, otherwise. */
json_t *json_read(const char *path, size_t limit, struct err *err);

/* Indented, keys in the order they were set, numbers with 12 digits; NaN and infinity must have been left out
 * (json_number). made_by: JSON text put under "made_by", or null. */
bool json_write(const char *path, json_t *object, const char *made_by, struct err *err);

/* A real, or null where it is not finite: JSON has neither NaN nor infinity. */
json_t *json_number(double x);

/* n numbers. */
json_t *json_numbers(int n, const double *x);

/* object.key as a number; null counts as NAN. False, err set (path, key, rule), when missing or something else. */
bool json_get(double *out, const json_t *object, const char *key, const char *path, struct err *err);

/* object.key as exactly n numbers. */
bool json_get_array(double *out, int n, const json_t *object, const char *key, const char *path, struct err *err);

/* object.key as a string, borrowed; null, err set, when it is none. */
const char *json_get_string(const json_t *object, const char *key, const char *path, struct err *err);

#endif
