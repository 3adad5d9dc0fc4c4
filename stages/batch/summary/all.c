#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "base/template.h"
#include "summary.h"

enum { QUEUED_LIMIT = 256 << 20, RESULT_LIMIT = 4096 };

/* The name as a scheduler's list has it: one line without control characters. */
static char *one_line(const char *name)
{
	char *line = mem_str(name);
	for (char *p = line; *p; p++)
		if ((unsigned char)*p < 0x20 || *p == 0x7f)
			*p = ' ';
	return line;
}

/* name -> [state, reason] */
static json_t *queued_load(const char *path)
{
	json_t *queued = json_object();
	struct err none = { 0 };
	char *text = 0, *rest;
	size_t size;
	if (!path || !file_read(&text, &size, path, QUEUED_LIMIT, &none))
		return queued;
	rest = text;
	for (char *line; (line = strsep(&rest, "\n"));) {
		char *name = strsep(&line, "\t"), *state = line ? strsep(&line, "\t") : 0;
		if (state && (!strcmp(state, "failed") || !strcmp(state, "runs") || !strcmp(state, "waits")))
			json_object_set_new_nocheck(queued, name, json_pack("[s,o]", state, template_text(line ? line : "")));
	}
	free(text);
	return queued;
}

/* A folder's name as a part of an address: any byte but letters, digits and -_. as %XX. */
static char *encoded(const char *name)
{
	char *out = mem_new(3 * strlen(name) + 1, 1), *at = out;
	for (; *name; name++)
		if (isascii((unsigned char)*name) && (isalnum((unsigned char)*name) || strchr("-_.", *name)))
			*at++ = *name;
		else
			at += sprintf(at, "%%%02X", (unsigned char)*name);
	return out;
}

static json_t *one(const char *dir, const char *name, const json_t *queued, const struct summary_conf *conf)
{
	struct err none = { 0 };
	char *row_path = summary_path(dir, "rows", name, ".json"), *result_path = mem_printf("%s/batch/results/%s", dir, name), *folder = encoded(name), *line = one_line(name);
	char *result = 0, hash[33];
	size_t size;
	file_hash_bytes(hash, name, strlen(name));
	json_t *row = json_read(row_path, ROW_LIMIT, &none), *known = json_object_get(queued, line);
	const char *state = json_string_value(json_array_get(known, 0));
	file_read(&result, &size, result_path, RESULT_LIMIT, &none);
	json_t *capture = json_pack("{s:o,s:s,s:s,s:s,s:O?,s:n,s:n}", "capture", template_text(name), "folder", folder, "hash", hash, "state",
	                            state ? state : "waits", "reason", json_array_get(known, 1), "seconds", "peak_mib");
	json_object_set_new(capture, "review", json_boolean(json_is_true(json_object_get(row, "review"))));
	json_object_set_new(capture, "thumb", json_boolean(json_is_array(json_object_get(row, "thumb"))));
	json_object_set_new(capture, "records", records_checked(json_object_get(row, "records")));
	summary_judge(capture, result, conf);
	json_decref(row);
	free(result);
	free(row_path);
	free(result_path);
	free(folder);
	free(line);
	return capture;
}

static int rank_of(const json_t *capture)
{
	static const char *const order[] = { "failed", "doubt", "runs", "waits", "pass" };
	const char *state = json_string_value(json_object_get(capture, "state"));
	int i = 0;
	while (i < COUNT(order) && strcmp(order[i], state))
		i++;
	return i;
}

static int worse_first(const void *pa, const void *pb)
{
	const json_t *a = *(json_t *const *)pa, *b = *(json_t *const *)pb;
	const int ra = rank_of(a), rb = rank_of(b);
	if (ra != rb)
		return ra - rb;
	const double sa = json_number_value(json_object_get(a, "score")), sb = json_number_value(json_object_get(b, "score"));
	return sa != sb ? (sa < sb ? 1 : -1) : strcmp(json_string_value(json_object_get(a, "folder")), json_string_value(json_object_get(b, "folder")));
}

json_t *summary_all(const char *dir, const char *queued_path, const struct summary_conf *conf, struct err *err)
{
	struct file_list list = { 0 };
	if (!file_list(&list, dir, err))
		return 0;
	json_t *queued = queued_load(queued_path), **found = mem_new((size_t)list.n + 1, sizeof *found), *all = json_array();
	int n = 0;
	for (int i = 0; i < list.n; i++) {
		struct stat st;
		char *path = mem_printf("%s/%s", dir, list.names[i]);
		if (strcmp(list.names[i], "batch") && !stat(path, &st) && S_ISDIR(st.st_mode))
			found[n++] = one(dir, list.names[i], queued, conf);
		free(path);
	}
	qsort(found, (size_t)n, sizeof *found, worse_first);
	for (int i = 0; i < n; i++)
		json_array_append_new(all, found[i]);
	free(found);
	json_decref(queued);
	file_list_free(&list);
	return all;
}
