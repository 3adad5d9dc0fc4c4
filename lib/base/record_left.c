#include "base/record_left.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/aside.h"
#include "base/asked.h"
#include "base/mem.h"

const char *const record_kinds[RECORD_KINDS] = { "outputs", "left" };

char *record_path_of(const char *key)
{
	if (*key != '%')
		return mem_str(key);
	char *path = mem_new(strlen(key) + 1, 1), *to = path;
	unsigned byte;
	for (const char *at = key + 1; sscanf(at, "%%%2x", &byte) == 1; at += 3)
		*to++ = (char)byte;
	return path;
}

bool record_same_maker(const struct record *r)
{
	return json_equal(json_object_get(r->old, "program"), json_object_get(r->now, "program"))
	       && json_equal(json_object_get(r->old, "config"), json_object_get(r->now, "config"));
}

static const json_t *entry(const json_t *record, const char *kind, const char *key)
{
	return json_object_get(json_object_get(record, kind), key);
}

/* What earlier runs have made, and this one has not asked for: path -> as in outputs; null where it cannot hold any more. json_decref */
static json_t *unclaimed(const struct record *r)
{
	json_t *all = json_object(), *made;
	const bool holds = record_same_maker(r);
	const char *key;
	for (int i = 0; i < RECORD_KINDS; i++)
		json_object_foreach(json_object_get(r->old, record_kinds[i]), key, made)
			if (!entry(r->now, "outputs", key) && !entry(r->now, "aside", key) && !json_object_get(all, key))
				json_object_set_new(all, key, holds && json_is_object(made) ? json_incref(made) : json_null());
	return all;
}

bool record_put_aside(struct record *r, const char *dir, struct err *err)
{
	json_t *all = unclaimed(r), *made;
	const size_t n = strlen(dir);
	const char *key;
	bool ok = true;
	// What a failing disk did not give may be there again for the next run: nothing is taken for gone.
	json_object_foreach(all, key, made) {
		char *rel = record_path_of(key);
		if (ok && !asked_trouble() && !strncmp(rel, dir, n) && rel[n] == '/') {
			ok = aside_put(r->capture, rel, err);
			json_object_set(json_object_get(r->now, "aside"), key, made);
		}
		free(rel);
	}
	json_decref(all);
	return ok;
}

/* What lay aside before this run, and was not asked for, stays there. */
static void keep_aside(struct record *r)
{
	json_t *aside = json_object_get(r->now, "aside"), *made;
	const bool holds = record_same_maker(r);
	const char *key;
	json_object_foreach(json_object_get(r->old, "aside"), key, made)
		if (!json_object_get(aside, key))
			json_object_set_new(aside, key, holds && !entry(r->now, "outputs", key) ? json_incref(made) : json_null());
}

void record_note_left(struct record *r)
{
	keep_aside(r);
	json_object_set_new(r->now, "left", unclaimed(r));
}

void record_distrust(struct record *r)
{
	json_t *left = json_object_get(r->now, "left"), *made;
	const char *key;
	json_object_foreach(json_object_get(r->now, "outputs"), key, made)
		json_object_set_new(left, key, json_null());
	json_object_set_new(r->now, "outputs", json_object());
}

static bool lies_aside(const struct record *r, const char *rel)
{
	char *away = aside_of(rel), *path = mem_printf("%s/%s", r->capture, away);
	const bool there = access(path, F_OK) == 0;
	free(away);
	free(path);
	return there;
}

bool record_settle(struct record *r, struct err *err)
{
	json_t *aside = json_object_get(r->now, "aside"), *made;
	const char *key;
	void *next;
	bool ok = true;
	// What this run has made anew, or a file that has the same place, is newer than what lies aside. All else stays there, though this program
	// and configuration may not know what to do with it: what was made is not lost.
	json_object_foreach(json_object_get(r->now, "outputs"), key, made) {
		char *rel = record_path_of(key);
		if (lies_aside(r, rel))
			ok = aside_drop(r->capture, rel, err) && ok;
		free(rel);
	}
	json_object_foreach_safe(aside, next, key, made) {
		char *rel = record_path_of(key);
		if (!lies_aside(r, rel))
			json_object_del(aside, key);
		free(rel);
	}
	json_object_del(r->now, "left");
	return ok;
}
