/* The table for statistics: a row for each capture as a whole, each photograph and each character; a column for each key of a part. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "summary.h"

enum { COLUMNS_MOST = 4096 };

static const char *text_of(const json_t *object, const char *key)
{
	const char *text = json_string_value(json_object_get(object, key));
	return text ? text : "";
}

/* What a record is told of: a photograph, a character, or the whole capture. */
static const char *kind_of(const json_t *record)
{
	const char *part = text_of(record, "part");
	if (!strcmp(part, "registration"))
		return "character";
	return !strcmp(part, "limbus") || !strcmp(part, "compare") || !strcmp(part, "unrefract") ? "photograph" : "capture";
}

/* "pigment.abl.melanin.value"; of the second eye "pigment_left.abl..."; free(). */
static char *column_of(const json_t *record, const char *key)
{
	const char *of = strcmp(kind_of(record), "capture") ? "" : text_of(record, "of");
	return mem_printf("%s%s%s.%s", text_of(record, "part"), *of ? "_" : "", of, key);
}

/* name -> index, in the order in which they are met. */
static json_t *columns_of(const json_t *captures)
{
	json_t *columns = json_object();
	const json_t *capture, *record, *value;
	const char *key;
	size_t i, k;
	json_array_foreach(captures, i, capture)
		json_array_foreach(json_object_get(capture, "records"), k, record)
			for (int t = 0; t < 2; t++)
				json_object_foreach(json_object_get(record, t ? "texts" : "numbers"), key, value) {
					char *name = column_of(record, key);
					if (!json_object_get(columns, name) && json_object_size(columns) < COLUMNS_MOST)
						json_object_set_new(columns, name, json_integer((json_int_t)json_object_size(columns)));
					free(name);
				}
	return columns;
}

static void put_text(FILE *f, const char *s)
{
	fputc('"', f);
	for (; *s; s++) {
		if (*s == '"')
			fputc('"', f);
		fputc((unsigned char)*s < 0x20 ? ' ' : *s, f);
	}
	fputc('"', f);
}

static void put_value(FILE *f, const json_t *value)
{
	if (json_is_string(value))
		put_text(f, json_string_value(value));
	else if (json_is_number(value))
		fprintf(f, "%.12g", json_number_value(value));
}

/* The capture's own columns, then the records of this kind and name (all of the capture for "capture"). */
static void put_row(FILE *f, const json_t *columns, const json_t *capture, const char *kind, const char *of)
{
	static const char *const own[] = { "state", "reason", "seconds", "peak_mib", "score" };
	const size_t n = json_object_size(columns);
	const json_t **cells = mem_new(n + 1, sizeof *cells), *record, *value;
	const char *key;
	size_t i;
	json_array_foreach(json_object_get(capture, "records"), i, record) {
		if (strcmp(kind_of(record), kind) || (strcmp(kind, "capture") && strcmp(text_of(record, "of"), of)))
			continue;
		for (int t = 0; t < 2; t++)
			json_object_foreach(json_object_get(record, t ? "texts" : "numbers"), key, value) {
				char *name = column_of(record, key);
				const json_t *at = json_object_get(columns, name);
				if (at)
					cells[json_integer_value(at)] = value;
				free(name);
			}
	}
	put_text(f, text_of(capture, "capture"));
	fprintf(f, ",%s,", kind);
	put_text(f, of);
	for (int k = 0; k < COUNT(own); k++) {
		fputc(',', f);
		put_value(f, json_object_get(capture, own[k]));
	}
	fputs(",\"", f);
	json_array_foreach(json_object_get(capture, "doubts"), i, value)
		for (const char *s = i ? "; " : "", *more = json_string_value(value); s; s = more, more = 0)
			for (; *s; s++)
				fputs(*s == '"' ? "\"\"" : (char[]){ (unsigned char)*s < 0x20 ? ' ' : *s, 0 }, f);
	fputc('"', f);
	for (size_t c = 0; c < n; c++) {
		fputc(',', f);
		put_value(f, cells[c]);
	}
	fputc('\n', f);
	free(cells);
}

/* Rows of a capture: itself, then each photograph and each character once. */
static void put_capture(FILE *f, const json_t *columns, const json_t *capture)
{
	json_t *done = json_object(), *record;
	size_t i;
	put_row(f, columns, capture, "capture", "");
	json_array_foreach(json_object_get(capture, "records"), i, record) {
		const char *kind = kind_of(record);
		char *name = mem_printf("%s %s", kind, text_of(record, "of"));
		if (strcmp(kind, "capture") && !json_object_get(done, name)) {
			json_object_set_new(done, name, json_true());
			put_row(f, columns, capture, kind, text_of(record, "of"));
		}
		free(name);
	}
	json_decref(done);
}

bool summary_csv(const json_t *captures, const char *path, struct err *err)
{
	char *text = 0;
	size_t size = 0, i;
	FILE *f = open_memstream(&text, &size);
	json_t *columns = columns_of(captures), *capture;
	const char *key;
	json_t *value;
	fputs("capture,row,name,state,reason,seconds,peak_mib,score,doubts", f);
	json_object_foreach(columns, key, value)
		fprintf(f, ",%s", key);
	fputc('\n', f);
	json_array_foreach(captures, i, capture)
		put_capture(f, columns, capture);
	fclose(f);
	bool ok = file_write(path, text, size, err);
	free(text);
	json_decref(columns);
	return ok;
}

bool summary_json(const json_t *captures, const char *path, struct err *err)
{
	char *text = 0;
	size_t size = 0, i;
	FILE *f = open_memstream(&text, &size);
	json_t *capture;
	fputs("{\"captures\": [", f);
	json_array_foreach(captures, i, capture) {
		fputs(i ? ",\n" : "\n", f);
		json_dumpf(capture, f, JSON_COMPACT | JSON_REAL_PRECISION(12));
	}
	fputs("\n]}\n", f);
	fclose(f);
	bool ok = file_write(path, text, size, err);
	free(text);
	return ok;
}
