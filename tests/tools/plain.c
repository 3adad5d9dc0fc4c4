/* plain: a text without what may differ between two revisions that do the same, for tests/same.sh.
 *
 *     plain code FILE      without comments (C's, C++'s), include guards and repeated white space: the interactive page's sources
 *     plain times FILE     without numbers that are seconds, shares of time or cells of a table of times: the review page
 */
#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"

/* Length of a comment that begins at text[at], or 0. "//" begins one at a line's beginning, after white space or ">", before a blank. */
static size_t comment(const char *text, size_t at)
{
	const char *c = text + at, *end;
	if (c[0] == '/' && c[1] == '*') {
		end = strstr(c + 2, "*/");
		return end ? (size_t)(end - c) + 2 : 0;
	}
	if (c[0] == '/' && c[1] == '/' && c[2] == ' ' && (!at || isspace((unsigned char)c[-1]) || c[-1] == '>'))
		return strcspn(c, "\n");
	return 0;
}

/* Length of "#ifndef NAME_H" or "#define NAME_H" at c, or 0. */
static size_t guard(const char *c)
{
	size_t n = !strncmp(c, "#ifndef ", 8) || !strncmp(c, "#define ", 8) ? 8 : 0, m;
	if (!n)
		return 0;
	m = strspn(c + n, "ABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789");
	return m > 2 && !strncmp(c + n + m - 2, "_H", 2) ? n + m : 0;
}

static void code(const char *text)
{
	bool blank = false;
	for (size_t i = 0; text[i];) {
		size_t skip = comment(text, i);
		skip = skip ? skip : guard(text + i);
		if (skip || isspace((unsigned char)text[i])) {
			blank = true;
			i += skip ? skip : 1;
			continue;
		}
		if (blank)
			putchar(' ');
		blank = false;
		putchar(text[i++]);
	}
	putchar('\n');
}

static void times(const char *text)
{
	static const char cell[] = "class=\"num\">";
	for (size_t i = 0; text[i];) {
		size_t n = isdigit((unsigned char)text[i]) ? strspn(text + i, "0123456789.") : 0, k = sizeof cell - 1;
		bool in_cell = i >= k && !strncmp(text + i - k, cell, k);
		if (n && !in_cell && strncmp(text + i + n, " s", 2) && text[i + n] != '%')
			fwrite(text + i, 1, n, stdout);
		if (!n)
			putchar(text[i++]);
		i += n;
	}
}

int main(int argc, char **argv)
{
	char *text;
	size_t size;
	struct err err = { 0 };
	bool is_code = argc == 3 && !strcmp(argv[1], "code"), is_times = argc == 3 && !strcmp(argv[1], "times");
	if (!is_code && !is_times) {
		fprintf(stderr, "usage: plain code|times FILE\n");
		return 2;
	}
	if (!file_read(&text, &size, argv[2], (size_t)1 << 30, &err)) {
		fprintf(stderr, "plain: %s\n", err.msg);
		return 1;
	}
	(is_code ? code : times)(text);
	free(text);
	return 0;
}
