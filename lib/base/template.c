#include "base/template.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

enum { DEPTH = 12, KEY = 64 };

struct context {
	const json_t *stack[DEPTH];
	int n;
	FILE *out;
	struct err *err;
};

static const json_t *look_up(const struct context *c, const char *key)
{
	if (!strcmp(key, "."))
		return c->stack[c->n - 1];
	for (int i = c->n - 1; i >= 0; i--) {
		const json_t *value = json_object_get(c->stack[i], key);
		if (value)
			return value;
	}
	return 0;
}

static void put_escaped(FILE *out, const char *s)
{
	for (; *s; s++)
		switch (*s) {
		case '&':
			fputs("&amp;", out);
			break;
		case '<':
			fputs("&lt;", out);
			break;
		case '>':
			fputs("&gt;", out);
			break;
		case '"':
			fputs("&quot;", out);
			break;
		case '\'':
			fputs("&#39;", out);
			break;
		default:
			// Control bytes have no meaning in HTML; some are errors.
			fputc((unsigned char)*s < 0x20 && *s != '\n' && *s != '\t' ? ' ' : *s, out);
		}
}

static void put_value(const struct context *c, const json_t *value, bool raw)
{
	if (json_is_string(value) && raw)
		fputs(json_string_value(value), c->out);
	else if (json_is_string(value))
		put_escaped(c->out, json_string_value(value));
	else if (json_is_integer(value))
		fprintf(c->out, "%lld", (long long)json_integer_value(value));
	else if (json_is_real(value))
		fprintf(c->out, "%.6g", json_real_value(value));
}

static bool is_there(const json_t *value)
{
	if (json_is_array(value))
		return json_array_size(value) > 0;
	if (json_is_string(value))
		return *json_string_value(value);
	return value && !json_is_false(value) && !json_is_null(value);
}

/* Finds the next placeholder in [at, end). Returns its beginning, or null; *kind is '&', '#', '^', '/' or 0, *after the byte
 * behind it. */
static const char *next_hole(const char *at, const char *end, char *kind, char key[KEY], const char **after)
{
	const char *open = memmem(at, (size_t)(end - at), "{{", 2);
	const char *close = open ? memmem(open, (size_t)(end - open), "}}", 2) : 0;
	if (!close)
		return 0;
	const char *from = open + 2;
	*kind = strchr("&#^/", *from) ? *from++ : 0;
	snprintf(key, KEY, "%.*s", (int)(close - from), from);
	*after = close + 2;
	return open;
}

/* Returns the end of the section that begins at `at`, or null where it is never closed; *after is behind its closing placeholder.
 * */
static const char *section_end(const char *at, const char *end, const char *key, const char **after)
{
	char kind, other[KEY];
	int depth = 0;
	const char *open;
	while ((open = next_hole(at, end, &kind, other, after))) {
		if (!strcmp(other, key)) {
			if (kind == '/' && depth-- == 0)
				return open;
			depth += kind == '#' || kind == '^';
		}
		at = *after;
	}
	return 0;
}

static bool fill(struct context *c, const char *at, const char *end);

static bool fill_with(struct context *c, const json_t *element, const char *at, const char *end)
{
	if (c->n == DEPTH)
		return err_set(c->err, "template: more than %d sections inside each other", DEPTH);
	c->stack[c->n++] = element;
	bool ok = fill(c, at, end);
	c->n--;
	return ok;
}

static bool fill_section(struct context *c, const json_t *value, bool inverted, const char *at, const char *end)
{
	if (inverted)
		return is_there(value) || fill(c, at, end);
	if (!is_there(value))
		return true;
	if (!json_is_array(value))
		return fill_with(c, value, at, end);
	size_t i;
	json_t *element;
	json_array_foreach((json_t *)value, i, element)
		if (!fill_with(c, element, at, end))
			return false;
	return true;
}

static bool fill(struct context *c, const char *at, const char *end)
{
	char kind, key[KEY];
	const char *open, *after;
	while ((open = next_hole(at, end, &kind, key, &after))) {
		fwrite(at, 1, (size_t)(open - at), c->out);
		at = after;
		if (kind == '/')
			return err_set(c->err, "template: {{/%s}} closes nothing", key);
		if (kind == '#' || kind == '^') {
			const char *close = section_end(after, end, key, &at);
			if (!close)
				return err_set(c->err, "template: {{%c%s}} is never closed", kind, key);
			if (!fill_section(c, look_up(c, key), kind == '^', after, close))
				return false;
		} else {
			put_value(c, look_up(c, key), kind == '&');
		}
	}
	fwrite(at, 1, (size_t)(end - at), c->out);
	return true;
}

bool template_fill(char **out, size_t *size, const char *text, const json_t *data, struct err *err)
{
	struct context c = { .stack = { data }, .n = 1, .err = err };
	*out = 0;
	*size = 0;
	c.out = open_memstream(out, size);
	bool ok = fill(&c, text, text + strlen(text));
	fclose(c.out);
	if (!ok) {
		free(*out);
		*out = 0;
	}
	return ok;
}

json_t *template_text(const char *bytes)
{
	json_t *text = json_string(bytes);
	if (text)
		return text;
	char *safe = mem_new(4 * strlen(bytes) + 1, 1), *at = safe;
	for (; *bytes; bytes++)
		if ((unsigned char)*bytes < 0x80)
			*at++ = *bytes;
		else
			at += sprintf(at, "\\x%02x", (unsigned char)*bytes);
	text = json_string(safe);
	free(safe);
	return text;
}
