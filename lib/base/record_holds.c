#include "base/record_holds.h"

#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/record_impl.h"
#include "base/record_left.h"

/* Whether one of the stage's patterns matches the key: "view.*.distance_mm" matches "view.a.distance_mm". */
static bool is_each(const json_t *patterns, const char *key)
{
	size_t i;
	json_t *pattern;
	json_array_foreach(patterns, i, pattern) {
		const char *text = json_string_value(pattern);
		if (text && opt_match(text, key, 0))
			return true;
	}
	return false;
}

static bool config_holds(const json_t *old, const char *stage, const struct conf *conf, char **why)
{
	const json_t *config = json_object_get(old, "config"), *patterns = json_object_get(old, "each");
	const struct conf_item *q = conf_find(conf, "quality", 0);
	const char *key;
	json_t *value;
	json_object_foreach((json_t *)config, key, value) {
		const struct conf_item *item = conf_find(conf, key, q ? q->value : 0);
		if (!item || !json_is_string(value) || strcmp(item->value, json_string_value(value))) {
			*why = mem_printf("%s has changed", key);
			return false;
		}
	}
	// A key that was not set when the stage ran is a change if it is the stage's own or matches one of its patterns; the shared keys
	// that it reads are all in the record.
	size_t m = strlen(stage);
	for (int i = 0; i < conf->n; i++) {
		const char *k = conf->items[i].key;
		bool own = !strncmp(k, stage, m) && k[m] == '.';
		if (conf->items[i].layer && (own || is_each(patterns, k)) && !json_object_get(config, k)) {
			*why = mem_printf("%s is new", k);
			return false;
		}
	}
	return true;
}

/* As record_hash, but looks at each file once, since every output may have the same hundred inputs. seen: path -> hash, or null. */
static const char *hash_once(struct record *r, json_t *seen, const char *rel)
{
	json_t *known = json_object_get(seen, rel);
	if (!known) {
		// A record may come with a stranger's capture: what it names outside of that is not read.
		const char *hash = *rel == '%' || !file_is_relative(rel) ? 0 : record_hash(r, rel);
		known = hash ? json_string(hash) : json_null();
		json_object_set_new(seen, rel, known);
	}
	return json_string_value(known);
}

static bool file_holds(struct record *r, json_t *seen, const char *rel, const json_t *was, const char *kind, char **why)
{
	const char *hash = hash_once(r, seen, rel), *old = json_string_value(was);
	const bool holds = old && !strcmp(hash ? hash : "", old);
	if (!holds)
		*why = mem_printf("%s %s %s", kind, rel, hash ? "has changed" : "is missing");
	return holds;
}

/* What the outputs were made of; made: and they themselves. */
static bool files_hold(struct record *r, bool made, char **why)
{
	json_t *seen = json_object(), *value, *was;
	const char *out, *in;
	bool holds = true;
	json_object_foreach(json_object_get(r->old, "outputs"), out, value) {
		holds = holds && (!made || file_holds(r, seen, out, json_object_get(value, "hash"), "output", why));
		json_object_foreach(json_object_get(value, "inputs"), in, was)
			holds = holds && file_holds(r, seen, in, was, "input", why);
	}
	json_decref(seen);
	return holds;
}

static bool lists_hold(struct record *r, char **why)
{
	const char *dir;
	json_t *value;
	json_object_foreach(json_object_get(r->old, "lists"), dir, value) {
		char *path = record_in_capture(r->capture, dir), hash[33];
		struct file_list list;
		struct err err = { 0 };
		file_list(&list, path, &err);
		record_listing_hash(hash, list.n, list.names);
		file_list_free(&list);
		free(path);
		if (!json_is_string(value) || strcmp(hash, json_string_value(value))) {
			*why = mem_printf("files have come or gone in %s/", dir);
			return false;
		}
	}
	return true;
}

/* What the stage has looked for in vain is still not there. */
static bool absence_holds(const struct record *r, char **why)
{
	size_t i;
	json_t *value;
	json_array_foreach(json_object_get(r->old, "absent"), i, value) {
		const char *rel = json_string_value(value);
		char *path = rel && *rel != '%' && file_is_relative(rel) ? record_in_capture(r->capture, rel) : 0;
		const bool there = path && file_exists(path);
		free(path);
		if (there) {
			*why = mem_printf("input %s is new", rel);
			return false;
		}
	}
	return true;
}

/* What only had to be there still is. */
static bool presence_holds(const struct record *r, char **why)
{
	const char *key;
	json_t *value;
	json_object_foreach(json_object_get(r->old, "there"), key, value) {
		char *rel = record_path_of(key), *path = file_is_relative(rel) ? record_in_capture(r->capture, rel) : 0;
		const bool there = path && file_exists(path);
		free(rel);
		free(path);
		if (!there) {
			*why = mem_printf("input %s is missing", key);
			return false;
		}
	}
	return true;
}

/* Saves the cache of hashes. It is only a memory: losing it costs time, nothing else. */
static void remember(const struct record *r)
{
	char *hashes = record_in_capture(r->capture, RECORD_HASHES);
	if (r->hashes_changed)
		record_save_json(hashes, r->hashes, &(struct err){ 0 });
	free(hashes);
}

bool record_inputs_hold(const char *capture, const char *stage)
{
	struct record *r = record_open_old(capture, stage);
	char *why = 0;
	const bool hold = lists_hold(r, &why) && absence_holds(r, &why) && presence_holds(r, &why) && files_hold(r, false, &why);
	remember(r);
	record_free(r);
	free(why);
	return hold;
}

bool record_holds(const char *capture, const char *stage, const char *program_path, const struct conf *conf,
                  char **why)
{
	char *reason = 0;
	struct record *r = record_open_old(capture, stage);
	const char *program = record_hash(r, program_path),
	           *was = json_string_value(json_object_get(r->old, "program"));
	bool holds = false;
	if (!json_is_true(json_object_get(r->old, "complete")))
		reason = mem_str(json_object_size(r->old) ? "its last run did not finish" : "never run");
	else if (!program || !was || strcmp(program, was))
		reason = mem_str("the program has changed");
	else
		holds = config_holds(r->old, stage, conf, &reason)
		        && lists_hold(r, &reason) && absence_holds(r, &reason) && presence_holds(r, &reason)
		        && files_hold(r, true, &reason);
	remember(r);
	record_free(r);
	if (why)
		*why = reason;
	else
		free(reason);
	return holds;
}

bool record_drop_altered(struct record *r, const char *dir, record_dropped *dropped, void *ctx, struct err *err)
{
	const char *rel;
	json_t *made;
	bool ok = true;
	size_t n = strlen(dir);
	json_object_foreach(json_object_get(r->old, "outputs"), rel, made) {
		const char *was = json_string_value(json_object_get(made, "hash")), *hash = 0;
		// A record may come with a stranger's capture: what is not below the folder is not ours to remove.
		if (strncmp(rel, dir, n) || rel[n] != '/' || strstr(rel, "..") || !was || !(hash = record_hash(r, rel)) || !strcmp(hash, was))
			continue;
		char *path = record_in_capture(r->capture, rel);
		ok = file_remove(path, err) && ok;
		free(path);
		dropped(ctx, rel);
	}
	return ok && record_save(r, false, err);
}
