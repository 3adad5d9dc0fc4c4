#include "base/say.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "base/err.h"
#include "base/file.h"
#include "base/mem.h"

static json_t *log_figures, *log_skips, *log_artifacts;  // of this process's one stage

static void print_line(const char *who, const char *text)
{
	size_t n = strlen(who) + 4 * strlen(text) + 4;
	char *line = mem_new(n, 1), *at = line;
	at += sprintf(at, "%s: ", who);
	for (const unsigned char *p = (const unsigned char *)text; *p; p++)
		if (*p < 0x20 || *p == 0x7f)
			at += sprintf(at, "\\x%02x", *p);
		else
			*at++ = (char)*p;
	*at++ = '\n';
	fwrite(line, 1, (size_t)(at - line), stderr);
	free(line);
}

void say_line(const char *who, const char *fmt, va_list ap)
{
	char *text = 0;
	if (vasprintf(&text, fmt, ap) >= 0)
		print_line(who, text);
	free(text);
}

void say_error(const char *who, const char *text)
{
	print_line(who, text);
}

void say_log_open(void)
{
	log_figures = json_object();
	log_skips = json_array();
	log_artifacts = json_object();
}

void say_log_figure(const char *key, double value, const char *unit)
{
	if (isfinite(value))
		json_object_set_new(log_figures, key, json_pack("{s:f,s:s}", "value", value, "unit", unit));
}

void say_log_skipped(const char *text)
{
	json_array_append_new(log_skips, json_string(text));
}

void say_log_artifact(const char *rel, bool made)
{
	if (made || !json_object_get(log_artifacts, rel))
		json_object_set_new(log_artifacts, rel, json_boolean(made));
}

void say_log_write(const char *path, const char *stage, double seconds, const char *error)
{
	const char *rel;
	json_t *is_made;
	int made = 0;
	json_object_foreach(log_artifacts, rel, is_made)
		made += json_is_true(is_made);
	json_t *artifacts = json_pack("{s:i,s:i}", "made", made, "kept", (int)json_object_size(log_artifacts) - made);
	struct rusage self, children;
	getrusage(RUSAGE_SELF, &self);
	getrusage(RUSAGE_CHILDREN, &children);
	long peak_kib = self.ru_maxrss > children.ru_maxrss ? self.ru_maxrss : children.ru_maxrss;
	json_t *log = json_pack("{s:s,s:f,s:i,s:s,s:o,s:o,s:o}", "stage", stage, "seconds", seconds, "peak_mib", (int)(peak_kib >> 10), "error", error,
	                        "figures", log_figures, "skipped", log_skips, "artifacts", artifacts);
	char *text = log ? json_dumps(log, JSON_INDENT(1) | JSON_SORT_KEYS) : 0;
	struct err err = { 0 };
	if (text)
		file_write(path, text, strlen(text), &err);  // a log that cannot be written is no reason to fail
	free(text);
	json_decref(log);
	json_decref(log_artifacts);
	log_figures = log_skips = log_artifacts = 0;
}
