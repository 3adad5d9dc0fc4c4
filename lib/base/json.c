#include "base/json.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"

static json_t *read_any(const char *path, size_t limit, json_type type, struct err *err)
{
	char *text;
	size_t size;
	if (!file_read(&text, &size, path, limit, err))
		return 0;
	json_error_t why;
	json_t *json = json_loadb(text, size, JSON_REJECT_DUPLICATES, &why);
	free(text);
	if (!json)
		err_set(err, "%s:%d: not JSON: %s", path, why.line, why.text);
	else if (json_typeof(json) != type) {
		json_decref(json);
		json = 0;
		err_set(err, "%s: must be a JSON %s", path, type == JSON_OBJECT ? "object" : "array");
	}
	return json;
}

json_t *json_read(const char *path, size_t limit, struct err *err)
{
	return read_any(path, limit, JSON_OBJECT, err);
}

json_t *json_read_array(const char *path, size_t limit, struct err *err)
{
	return read_any(path, limit, JSON_ARRAY, err);
}

bool json_write(const char *path, json_t *object, const char *made_by, struct err *err)
{
	if (made_by)
		json_object_set_new(object, "made_by", json_loads(made_by, 0, 0));
	char *text = json_dumps(object, JSON_INDENT(1) | JSON_REAL_PRECISION(12));
	bool ok = text ? file_write(path, text, strlen(text), err) : err_set(err, "%s: cannot be put into JSON", path);
	free(text);
	return ok;
}

json_t *json_number(double x)
{
	return isfinite(x) ? json_real(x) : json_null();
}

json_t *json_numbers(int n, const double *x)
{
	json_t *array = json_array();
	for (int i = 0; i < n; i++)
		json_array_append_new(array, json_number(x[i]));
	return array;
}

static bool number_of(double *out, const json_t *value)
{
	if (json_is_null(value))
		*out = NAN;
	else if (json_is_number(value))
		*out = json_number_value(value);
	else
		return false;
	return true;
}

bool json_get(double *out, const json_t *object, const char *key, const char *path, struct err *err)
{
	return number_of(out, json_object_get(object, key)) || err_set(err, "%s: %s: must be a number", path, key);
}

bool json_get_array(double *out, int n, const json_t *object, const char *key, const char *path, struct err *err)
{
	const json_t *array = json_object_get(object, key);
	bool ok = json_is_array(array) && (int)json_array_size(array) == n;
	for (int i = 0; i < n && ok; i++)
		ok = number_of(&out[i], json_array_get(array, (size_t)i));
	return ok || err_set(err, "%s: %s: must be %d numbers", path, key, n);
}

const char *json_get_string(const json_t *object, const char *key, const char *path, struct err *err)
{
	const char *s = json_string_value(json_object_get(object, key));
	if (!s)
		err_set(err, "%s: %s: must be a string", path, key);
	return s;
}
