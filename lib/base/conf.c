#include "base/conf.h"

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
	int line, layer, first_item;
	struct err *err;
};

/* inih's own reader silently cuts long lines and does not tell line numbers to the handler; this one does. */
static char *next_line(char *buf, int size, void *user)
{
	struct reading *r = user;
	if (!*r->at || err_is(r->err))
		return 0;
	const char *end = strchr(r->at, '\n');
	size_t n = end ? (size_t)(end - r->at) + 1 : strlen(r->at);
	r->line++;
	if (n > CONF_LINE_LIMIT || n + 1 > (size_t)size) {
		err_set(r->err, "%s:%d: line of %zu bytes, must be <= %d", r->file, r->line, n,
		        size - 2 < CONF_LINE_LIMIT ? size - 2 : CONF_LINE_LIMIT);
		return 0;
	}
	memcpy(buf, r->at, n);
	buf[n] = 0;
	r->at += n;
	// An indented line would continue the value above in inih: here a line is a line.
	if (*buf == ' ' || *buf == '\t')
		memmove(buf, buf + strspn(buf, " \t"), n + 1 - strspn(buf, " \t"));
	return buf;
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
	append(r->conf, (struct conf_item){ key, mem_str(value ? value : ""), r->file, r->line, r->layer });
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
