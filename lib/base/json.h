/* json: JSON files, read with errors that name file, key and rule, and written atomically (Jansson). */
#ifndef BASE_JSON_H
#define BASE_JSON_H
#include <jansson.h>

#include "base/err.h"

/* Reads a file of at most `limit` bytes that holds one JSON object. json_decref. Returns null, err set, otherwise. */
json_t *json_read(const char *path, size_t limit, struct err *err);

/* The same of a file that holds one JSON array. */
json_t *json_read_array(const char *path, size_t limit, struct err *err);

/* Writes an object, indented, keys in the order they were set, numbers with 12 digits. Numbers must be finite (json_number).
 * made_by: JSON text put under "made_by", or null. Returns false, err set, when the file cannot be written. */
bool json_write(const char *path, json_t *object, const char *made_by, struct err *err);

/* A JSON real; JSON's null where x is not finite, since JSON has neither NaN nor infinity. */
json_t *json_number(double x);

/* A JSON array of n numbers. */
json_t *json_numbers(int n, const double *x);

/* object.key as a number; null is read as NAN. Returns false, err set (path, key, rule), when it is missing or something else. */
bool json_get(double *out, const json_t *object, const char *key, const char *path, struct err *err);

/* object.key as an array of exactly n numbers: out[n]. */
bool json_get_array(double *out, int n, const json_t *object, const char *key, const char *path, struct err *err);

/* object.key as a string, owned by the object. Returns null, err set, when it is no string. */
const char *json_get_string(const json_t *object, const char *key, const char *path, struct err *err);

#endif
