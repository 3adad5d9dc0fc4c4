#include "base/opt.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

static bool is_shared(const char *key)
{
	return strchr(key, '.') || !strcmp(key, "quality");
}

char *opt_full_key(const char *stage, const char *key)
{
	return is_shared(key) ? mem_str(key) : mem_printf("%s.%s", stage, key);
}

bool opt_match(const char *pattern, const char *key, char **name)
{
	const char *star = strchr(pattern, '*');
	if (name)
		*name = 0;
	if (!star)
		return !strcmp(pattern, key);
	size_t head = (size_t)(star - pattern), tail = strlen(star + 1), n = strlen(key);
	if (n <= head + tail || strncmp(pattern, key, head) || strcmp(star + 1, key + n - tail))
		return false;
	if (name)
		*name = mem_printf("%.*s", (int)(n - head - tail), key + head);
	return true;
}

static const char *quality_of(const struct conf *conf)
{
	const struct conf_item *item = conf_find(conf, "quality", 0);
	return item ? item->value : 0;
}

/* Sets err to "file:line: key = value: rule". Returns false. */
static bool refuse(const struct conf_item *item, const char *key, const char *rule, struct err *err)
{
	if (item->line)
		return err_set(err, "%s:%d: %s = %.80s: %s", item->file, item->line, key, item->value, rule);
	return err_usage(err, "%s: %s = %.80s: %s", item->file, key, item->value, rule);
}

static bool refuse_range(const struct conf_item *item, const struct opt *o, struct err *err)
{
	char rule[160];
	int n = snprintf(rule, sizeof rule, "must be %s in [%g, %g]%s%s",
	         o->type == OPT_T_INT ? "a whole number" : o->count > 1 ? "numbers" : "a number", o->min, o->max,
	         *o->unit ? " " : "", o->unit);
	if (o->count > 1 && n > 0 && n < (int)sizeof rule)
		snprintf(rule + n, sizeof rule - (size_t)n, ", %d of them", o->count);
	return refuse(item, o->key, rule, err);
}

/* Reads exactly `count` numbers in range. */
static bool read_numbers(double *out, int count, const struct opt *o, const struct conf_item *item, struct err *err)
{
	const char *at = item->value;
	for (int i = 0; i < count; i++) {
		char *end;
		errno = 0;
		out[i] = strtod(at, &end);
		if (end == at || !(out[i] >= o->min && out[i] <= o->max))
			return refuse_range(item, o, err);
		at = end;
	}
	at += strspn(at, " \t");
	return *at ? refuse_range(item, o, err) : true;
}

static bool read_choice(const struct opt *o, const struct conf_item *item, struct err *err)
{
	char rule[256] = "must be one of";
	for (int i = 0; o->choices[i]; i++) {
		if (!strcmp(o->choices[i], item->value)) {
			*o->out.integer = i;
			return true;
		}
		size_t n = strlen(rule);
		snprintf(rule + n, sizeof rule - n, " %s", o->choices[i]);
	}
	return refuse(item, o->key, rule, err);
}

static bool read_bool(const struct opt *o, const struct conf_item *item, struct err *err)
{
	bool yes = !strcmp(item->value, "yes"), no = !strcmp(item->value, "no");
	if (!yes && !no)
		return refuse(item, o->key, "must be yes or no", err);
	*o->out.boolean = yes;
	return true;
}

static bool read_value(const struct opt *o, const struct conf_item *item, struct err *err)
{
	double x;
	if (!*item->value) {
		if (!o->may_unset)
			return refuse(item, o->key, "needs a value", err);
		if (o->type == OPT_T_STR)
			*o->out.str = 0;
		else
			for (int i = 0; i < o->count; i++)
				o->out.real[i] = NAN;
		return true;
	}
	switch (o->type) {
	case OPT_T_REAL:
	case OPT_T_REALS:
		return read_numbers(o->out.real, o->count, o, item, err);
	case OPT_T_INT:
		if (!read_numbers(&x, 1, o, item, err))
			return false;
		if (x != floor(x))
			return refuse_range(item, o, err);
		*o->out.integer = (int)x;
		return true;
	case OPT_T_BOOL:
		return read_bool(o, item, err);
	case OPT_T_CHOICE:
		return read_choice(o, item, err);
	case OPT_T_STR:
		*o->out.str = item->value;
		return true;
	case OPT_T_EACH:
		break;
	}
	return true;
}

static bool read_each(const struct opt *o, const char *pattern, const struct conf *conf, struct err *err)
{
	*o->out.each = (struct opt_each_list){ 0 };
	for (int i = 0; i < conf->n; i++) {
		const struct conf_item *item = &conf->items[i];
		char *name;
		if (!item->layer || !opt_match(pattern, item->key, &name))
			continue;
		if (conf_find(conf, item->key, 0) != item) {  // a later layer overrides it
			free(name);
			continue;
		}
		struct opt_each_list *list = o->out.each;
		list->items = mem_grow(list->items, (size_t)list->n + 1, sizeof *list->items);
		struct opt_each *each = &list->items[list->n++];
		*each = (struct opt_each){ .name = name, .text = item->value };
		if (o->count && !read_numbers(each->value, o->count, o, item, err))
			return false;
	}
	return true;
}

static bool check_known(const char *stage, int n, const struct opt opts[], const struct conf *conf, struct err *err)
{
	size_t m = strlen(stage);
	for (int i = 0; i < conf->n; i++) {
		const struct conf_item *item = &conf->items[i];
		if (strncmp(item->key, stage, m) || item->key[m] != '.')
			continue;
		const char *key = item->key + m + 1;
		bool known = false;
		for (int j = 0; j < n && !known; j++) {
			size_t k = strlen(opts[j].key);
			known = opt_match(opts[j].key, key, 0)
			        || (!item->layer && !strncmp(opts[j].key, key, k) && key[k] == '.');
		}
		if (!known)
			return refuse(item, item->key, "unknown key", err);
	}
	return true;
}

static double number_of(const struct opt *o)
{
	return o->type == OPT_T_INT ? *o->out.integer : *o->out.real;
}

/* Of min_X and max_X of one unit the first is not the greater. */
static bool check_ordered(const char *stage, int n, const struct opt opts[], struct err *err)
{
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			const struct opt *a = &opts[i], *b = &opts[j];
			const bool numbers = a->count == 1 && b->count == 1 && a->type == b->type && (a->type == OPT_T_REAL || a->type == OPT_T_INT);
			if (!numbers || strncmp(a->key, "min_", 4) || strncmp(b->key, "max_", 4) || strcmp(a->key + 4, b->key + 4)
			    || strcmp(a->unit, b->unit) || !(number_of(a) > number_of(b)))
				continue;
			return err_set(err, "%s.%s = %g with %s.%s = %g: the first must not be the greater", stage, a->key, number_of(a), stage, b->key,
			               number_of(b));
		}
	return true;
}

bool opt_resolve(const char *stage, int n, const struct opt opts[], const struct conf *conf, struct err *err)
{
	const char *quality = quality_of(conf);
	for (int i = 0; i < n; i++) {
		const struct opt *o = &opts[i];
		if (o->type == OPT_T_EACH) {
			char *pattern = opt_full_key(stage, o->key);
			bool ok = read_each(o, pattern, conf, err);
			free(pattern);
			if (!ok)
				return false;
			continue;
		}
		char *key = opt_full_key(stage, o->key);
		const struct conf_item *item = conf_find(conf, key, quality);
		bool ok = item ? read_value(o, item, err) : err_set(err, "%s: has no default in config/", key);
		free(key);
		if (!ok)
			return false;
	}
	return check_ordered(stage, n, opts, err) && check_known(stage, n, opts, conf, err);
}

static int by_text(const void *a, const void *b)
{
	return strcmp(*(char *const *)a, *(char *const *)b);
}

void opt_print(FILE *out, const char *stage, int n, const struct opt opts[], const struct conf *conf)
{
	char **lines = 0;
	int count = 0;
	for (int i = 0; i < n; i++) {
		char *key = opt_full_key(stage, opts[i].key);
		if (opts[i].type != OPT_T_EACH) {
			const struct conf_item *item = conf_find(conf, key, quality_of(conf));
			lines = mem_grow(lines, (size_t)count + 1, sizeof *lines);
			lines[count++] = mem_printf("%s = %s", key, item ? item->value : "");
		} else
			for (int k = 0; k < conf->n; k++)
				if (conf->items[k].layer && opt_match(key, conf->items[k].key, 0)
				    && conf_find(conf, conf->items[k].key, 0) == &conf->items[k]) {
					lines = mem_grow(lines, (size_t)count + 1, sizeof *lines);
					lines[count++] = mem_printf("%s = %s", conf->items[k].key, conf->items[k].value);
				}
		free(key);
	}
	if (count)
		qsort(lines, (size_t)count, sizeof *lines, by_text);
	for (int i = 0; i < count; i++) {
		fprintf(out, "%s\n", lines[i]);
		free(lines[i]);
	}
	free(lines);
}

static void print_rule(FILE *out, const struct opt *o)
{
	if (o->type == OPT_T_CHOICE) {
		for (int i = 0; o->choices[i]; i++)
			fprintf(out, "%s%s", i ? "|" : "", o->choices[i]);
	} else if (o->type == OPT_T_BOOL)
		fputs("yes|no", out);
	else if (o->type != OPT_T_STR && o->count)
		fprintf(out, "%g..%g%s%s", o->min, o->max, *o->unit ? " " : "", o->unit);
}

void opt_help(FILE *out, const char *stage, int n, const struct opt opts[], const struct conf *conf)
{
	for (int i = 0; i < n; i++) {
		const struct opt *o = &opts[i];
		char *key = opt_full_key(stage, o->key);
		const struct conf_item *item = conf_find(conf, key, quality_of(conf));
		fprintf(out, "  --%s=%s  (", o->key, item && *item->value ? item->value : "");
		print_rule(out, o);
		fprintf(out, ")\n      %s\n", o->help);
		free(key);
	}
}

void opt_free(int n, const struct opt opts[])
{
	for (int i = 0; i < n; i++)
		if (opts[i].type == OPT_T_EACH) {
			for (int j = 0; j < opts[i].out.each->n; j++)
				free(opts[i].out.each->items[j].name);
			free(opts[i].out.each->items);
			*opts[i].out.each = (struct opt_each_list){ 0 };
		}
}
