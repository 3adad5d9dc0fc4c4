#include "base/conf.h"

#include <ctype.h>
#include <ini.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"

enum { CONF_FILE_LIMIT = 1 << 20, CONF_LINE_LIMIT = 1000 };

struct reading {
	struct conf *conf;
	const char *prefix, *at;  // at: next unread byte
	const char *file;
	const char *value;        // of the line that inih has the key of alone, or null
	size_t value_size;
	int line, layer, first_item;
	struct err *err;
};

/* Gives inih (ini_parse_stream) the next line. inih's own reader cuts a line where its buffer ends (`size` bytes; 200 as Debian builds it)
 * and does not pass line numbers to the handler. Of a line that does not fit, inih gets the key alone, and take() reads the value. */
static char *next_line(char *buf, int size, void *user)
{
	struct reading *r = user;
	if (!*r->at || err_is(r->err))
		return 0;
	size_t n = strcspn(r->at, "\n"), room = (size_t)size - 1;
	// An indented line would continue the value above in inih: here a line is a line.
	size_t indent = strspn(r->at, " \t"), length = n - (indent < n ? indent : n);
	const char *line = r->at + n - length;
	r->line++;
	r->at += n + (r->at[n] == '\n');
	r->value = 0;
	if (n > CONF_LINE_LIMIT) {
		err_set(r->err, "%s:%d: line of %zu bytes, must be <= %d", r->file, r->line, n, CONF_LINE_LIMIT);
		return 0;
	}
	if (length > room && !strchr(";#[", *line)) {
		size_t key = strcspn(line, "=:");
		if (key < length) {
			r->value = line + key + 1;
			r->value_size = length - key - 1;
			length = key + 1;
		}
		if (length > room && r->value) {
			err_set(r->err, "%s:%d: key of %zu bytes, must be <= %zu", r->file, r->line, key, room - 1);
			return 0;
		}
	}
	length = length < room ? length : room;  // what is cut here is a comment, or no "key = value" anyway
	memcpy(buf, line, length);
	buf[length] = 0;
	return buf;
}

/* The value of a long line as inih would have read it: without spaces round it, and without a comment, which begins with a
 * semicolon behind a space. free(). */
static char *long_value(const char *at, size_t n)
{
	size_t end = 0;
	while (end < n && !(at[end] == ';' && end && isspace((unsigned char)at[end - 1])))
		end++;
	while (end && isspace((unsigned char)at[end - 1]))
		end--;
	while (end && isspace((unsigned char)*at))
		at++, end--;
	return mem_printf("%.*s", (int)end, at);
}

static void append(struct conf *conf, struct conf_item item)
{
	conf->items = mem_grow(conf->items, (size_t)conf->n + 1, sizeof *conf->items);
	conf->items[conf->n++] = item;
}

static int take(void *user, const char *section, const char *name, const char *value)
{
	struct reading *r = user;
	if (*section) {
		err_set(r->err, "%s:%d: [%.60s]: sections are not used here", r->file, r->line, section);
		return 0;
	}
	char *key = mem_printf("%s%s", r->prefix, name);
	for (int i = r->first_item; i < r->conf->n; i++)
		if (!strcmp(r->conf->items[i].key, key)) {
			err_set(r->err, "%s:%d: %s: given twice, first in line %d", r->file, r->line, name,
			        r->conf->items[i].line);
			free(key);
			return 0;
		}
	char *own = r->value ? long_value(r->value, r->value_size) : mem_str(value ? value : "");
	append(r->conf, (struct conf_item){ key, own, r->file, r->line, r->layer });
	return 1;
}

bool conf_load(struct conf *conf, const char *path, const char *prefix, int layer, struct err *err)
{
	char *text;
	size_t size;
	if (layer == 1 && !file_exists(path))
		return true;
	if (!file_read(&text, &size, path, CONF_FILE_LIMIT, err))
		return false;
	conf->files = mem_grow(conf->files, (size_t)conf->n_files + 1, sizeof *conf->files);
	conf->files[conf->n_files++] = mem_str(path);
	struct reading r = { .conf = conf, .prefix = prefix, .at = text, .layer = layer, .first_item = conf->n,
	                     .file = conf->files[conf->n_files - 1], .err = err };
	if (memchr(text, 0, size))
		err_set(err, "%s: has a zero byte: not a text file", path);
	else {
		if (!strncmp(text, "\xef\xbb\xbf", 3))
			r.at += 3;
		int bad = ini_parse_stream(next_line, &r, take, &r);
		if (bad)
			err_set(err, "%s:%d: not of the form key = value", path, bad > 0 ? bad : r.line);
	}
	free(text);
	return !err_is(err);
}

void conf_add(struct conf *conf, const char *key, const char *value)
{
	append(conf, (struct conf_item){ mem_str(key), mem_str(value), "command line", 0, 2 });
}

const struct conf_item *conf_find(const struct conf *conf, const char *key, const char *quality)
{
	const struct conf_item *best = 0;
	size_t n = strlen(key);
	int best_rank = -1;
	for (int i = 0; i < conf->n; i++) {
		const struct conf_item *item = &conf->items[i];
		if (strncmp(item->key, key, n))
			continue;
		bool plain = !item->key[n];
		bool preset = quality && !item->layer && item->key[n] == '.' && !strcmp(item->key + n + 1, quality);
		int rank = 2 * item->layer + preset;
		if ((plain || preset) && rank >= best_rank) {
			best = item;
			best_rank = rank;
		}
	}
	return best;
}

void conf_free(struct conf *conf)
{
	for (int i = 0; i < conf->n; i++) {
		free(conf->items[i].key);
		free(conf->items[i].value);
	}
	for (int i = 0; i < conf->n_files; i++)
		free(conf->files[i]);
	free(conf->items);
	free(conf->files);
	*conf = (struct conf){ 0 };
}
