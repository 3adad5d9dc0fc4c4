#include "base/record_impl.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#include "base/aside.h"
#include "base/asked.h"
#include "base/file.h"
#include "base/mem.h"
#include "base/record_left.h"

char *record_in_capture(const char *capture, const char *rel)
{
	return *rel == '/' ? mem_str(rel) : mem_printf("%s/%s", capture, rel);
}

static char *record_path(const char *capture, const char *stage)
{
	return mem_printf("%s/work/.made/%s.json", capture, stage);
}

/* Loads a JSON object; an empty one where it cannot be read: the stage then runs again. */
static json_t *load_object(const char *path)
{
	enum { LIMIT = 256 << 20 };
	char *text;
	size_t size;
	struct err none = { 0 };
	json_t *json = file_read(&text, &size, path, LIMIT, &none) ? json_loadb(text, size, 0, 0) : 0;
	free(text);
	if (!json_is_object(json)) {
		json_decref(json);
		json = json_object();
	}
	return json;
}

static json_t *config_object(const char *lines)
{
	json_t *config = json_object();
	while (*lines) {
		const char *end = strchrnul(lines, '\n'), *eq = memmem(lines, (size_t)(end - lines), " = ", 3);
		if (eq) {
			char *key = mem_printf("%.*s", (int)(eq - lines), lines);
			json_object_set_new(config, key, json_stringn_nocheck(eq + 3, (size_t)(end - eq - 3)));
			free(key);
		}
		lines = *end ? end + 1 : end;
	}
	return config;
}

struct record *record_open_old(const char *capture, const char *stage)
{
	struct record *r = mem_new(1, sizeof *r);
	char *hashes = record_in_capture(capture, RECORD_HASHES);
	char *old = record_path(capture, stage);
	r->capture = mem_str(capture);
	r->stage = stage;
	r->hashes = load_object(hashes);
	r->old = load_object(old);
	free(hashes);
	free(old);
	return r;
}

struct record *record_open(const char *capture, const char *stage, const char *program_path, const char *config)
{
	struct record *r = record_open_old(capture, stage);
	r->now = json_object();
	json_object_set_new(r->now, "stage", json_string(stage));
	const char *program = record_hash(r, program_path);
	json_object_set_new(r->now, "program", json_string(program ? program : ""));
	json_object_set_new(r->now, "config", config_object(config));
	json_object_set_new(r->now, "each", json_array());
	json_object_set_new(r->now, "lists", json_object());
	json_object_set_new(r->now, "there", json_object());
	json_object_set_new(r->now, "outputs", json_object());
	json_object_set_new(r->now, "aside", json_object());
	return r;
}

void record_free(struct record *r)
{
	if (!r)
		return;
	json_decref(r->old);
	json_decref(r->now);
	json_decref(r->hashes);
	free(r->capture);
	free(r);
}

static json_int_t ns(struct timespec t)
{
	return (json_int_t)t.tv_sec * 1000000000 + t.tv_nsec;
}

static bool same_file(const json_t *entry, const struct stat *st)
{
	return json_integer_value(json_object_get(entry, "size")) == (json_int_t)st->st_size
	       && json_integer_value(json_object_get(entry, "inode")) == (json_int_t)st->st_ino
	       && json_integer_value(json_object_get(entry, "mtime")) == ns(st->st_mtim)
	       && json_integer_value(json_object_get(entry, "ctime")) == ns(st->st_ctim);
}

/* A file name as a JSON key: names are bytes, JSON is UTF-8. A name that is not UTF-8 is escaped so that no two names get one
 * key. */
static char *json_key(const char *rel)
{
	json_t *probe = json_string(rel);
	if (probe) {
		json_decref(probe);
		return mem_str(rel);
	}
	char *key = mem_new(3 * strlen(rel) + 2, 1), *at = key;
	*at++ = '%';
	for (; *rel; rel++)
		at += sprintf(at, "%%%02x", (unsigned char)*rel);
	return key;
}

/* The longest file that is read to its end, by the folder it stands in. */
static uint64_t limit_of(const char *rel)
{
	const bool photo = !strncmp(rel, "photos/", 7) || !strncmp(rel, "views/", 6), video = !strncmp(rel, "video/", 6);
	return (uint64_t)(photo ? 2 : video ? 256 : 16) << 30;
}

const char *record_hash(struct record *r, const char *rel)
{
	char *path = record_in_capture(r->capture, rel), *key = json_key(rel);
	struct stat st;
	const char *hash = 0;
	if (stat(path, &st) == 0 && S_ISREG(st.st_mode)) {
		json_t *entry = json_object_get(r->hashes, key);
		struct timespec now;
		clock_gettime(CLOCK_REALTIME, &now);
		if (!entry || !same_file(entry, &st)) {
			char text[33];
			struct err err = { 0 };
			entry = 0;
			if (file_hash(text, path, limit_of(rel), &err)) {
				// A file written this very moment may change again within the clock's grain: do not trust its date.
				bool settled = ns(now) - ns(st.st_mtim) > 50000000;
				entry = json_pack("{s:I,s:I,s:I,s:I,s:s}", "size", (json_int_t)st.st_size, "inode",
				                  (json_int_t)st.st_ino, "mtime", settled ? ns(st.st_mtim) : 0, "ctime",
				                  ns(st.st_ctim), "hash", text);
				json_object_set_new(r->hashes, key, entry);
				r->hashes_changed = true;
			}
		}
		hash = entry ? json_string_value(json_object_get(entry, "hash")) : 0;
	}
	free(path);
	free(key);
	return hash;
}

void record_list(struct record *r, const char *dir, const char *hash)
{
	json_object_set_new(json_object_get(r->now, "lists"), dir, json_string(hash));
}

void record_there(struct record *r, const char *rel)
{
	char *key = json_key(rel);
	json_object_set_new(json_object_get(r->now, "there"), key, json_true());
	free(key);
}

void record_each(struct record *r, const char *pattern)
{
	json_array_append_new(json_object_get(r->now, "each"), json_string(pattern));
}

void record_listing_hash(char out[33], int n, char *const names[])
{
	size_t size = 0;
	char *all = 0;
	for (int i = 0; i < n; i++) {
		size_t m = strlen(names[i]) + 1;
		all = mem_grow(all, size + m, 1);
		memcpy(all + size, names[i], m);
		size += m;
	}
	file_hash_bytes(out, all ? all : "", size);
	free(all);
}

static json_t *input_hashes(struct record *r, int n, const char *const in[])
{
	json_t *inputs = json_object();
	for (int i = 0; i < n; i++) {
		const char *hash = record_hash(r, in[i]);
		char *key = json_key(in[i]);
		json_object_set_new(inputs, key, json_string(hash ? hash : ""));
		free(key);
	}
	return inputs;
}

/* Takes `made`. What this run has put aside under that path is of no use then. */
static void claim(struct record *r, const char *key, json_t *made)
{
	json_t *aside = json_object_get(r->now, "aside");
	json_object_set_new(json_object_get(r->now, "outputs"), key, made);
	if (json_object_get(aside, key))
		json_object_set_new(aside, key, json_null());
}

bool record_fresh(struct record *r, const char *out, int n, const char *const in[])
{
	char *key = json_key(out), *away = 0;
	static const char *const kinds[] = { "outputs", "left", "aside" };
	json_t *made = 0;
	for (int i = 0; i < COUNT(kinds) && !made; i++)
		made = json_object_get(json_object_get(r->old, kinds[i]), key);
	const char *hash = made ? record_hash(r, out) : 0, *was = json_string_value(json_object_get(made, "hash"));
	if (made && !hash)
		hash = record_hash(r, away = aside_of(out));
	bool fresh = hash && was && !strcmp(hash, was) && record_same_maker(r);
	if (fresh) {
		json_t *inputs = input_hashes(r, n, in);
		fresh = json_equal(inputs, json_object_get(made, "inputs")) && (!away || aside_take(r->capture, out));
		json_decref(inputs);
	}
	if (fresh)
		claim(r, key, json_incref(made));
	free(key);
	free(away);
	return fresh;
}

void record_made(struct record *r, const char *out, int n, const char *const in[])
{
	const char *hash = record_hash(r, out);
	char *key = json_key(out);
	json_t *made = json_object();
	json_object_set_new(made, "hash", json_string(hash ? hash : ""));
	json_object_set_new(made, "inputs", input_hashes(r, n, in));
	claim(r, key, made);
	free(key);
}

void record_keep(struct record *r)
{
	if (record_same_maker(r))
		json_object_update_missing(json_object_get(r->now, "outputs"), json_object_get(r->old, "outputs"));
}

bool record_save_json(const char *path, const json_t *json, struct err *err)
{
	char *text = json_dumps(json, JSON_INDENT(1) | JSON_SORT_KEYS);
	bool ok = text && file_write(path, text, strlen(text), err);
	free(text);
	return ok;
}

static void add_absent(void *list, const char *rel)
{
	static const char memory[] = "work/.made/";  // of earlier runs: no result depends on it
	if (!strncmp(rel, memory, sizeof memory - 1))
		return;
	char *key = json_key(rel);
	json_array_append_new(list, json_string(key));
	free(key);
}

bool record_save(struct record *r, bool complete, struct err *err)
{
	json_t *absent = json_array();
	asked_absent(add_absent, absent);
	json_object_set_new(r->now, "absent", absent);
	record_note_left(r);
	// A disk that failed to give a file: what was made without it is made again.
	if (asked_trouble()) {
		complete = false;
		record_distrust(r);
	}
	char *path = record_path(r->capture, r->stage), *hashes = record_in_capture(r->capture, RECORD_HASHES);
	json_object_set_new(r->now, "complete", json_boolean(complete));
	bool ok = (!complete || record_settle(r, err)) && record_save_json(path, r->now, err);
	if (ok && r->hashes_changed)
		ok = record_save_json(hashes, r->hashes, err);
	free(path);
	free(hashes);
	return ok;
}
