#include "base/csv.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"

enum { COLUMNS_MAX = 4096, NAME_MAX_BYTES = 200 };
static const size_t bytes_max = (size_t)1 << 30;

struct text {
	const char *path;
	char *at, *end;
	char separator;
	int line;
};

/* Returns the next field of the line, a string in place; *last: the line has no more. Null, err set, where a quote does not end. */
static char *next_field(struct text *t, bool *last, struct err *err)
{
	char *from = t->at, *p = from, *to = from;
	bool quoted = *p == '"';
	p += quoted;
	for (; p < t->end && (quoted || (*p != t->separator && *p != '\n')); p++) {
		if (quoted && *p == '\n')
			break;
		if (quoted && *p == '"') {
			if (p[1] != '"') {
				quoted = false;
				continue;
			}
			p++;
		}
		*to++ = *p;
	}
	if (quoted) {
		err_set(err, "%s:%d: a quote that does not end", t->path, t->line);
		return 0;
	}
	*last = p == t->end || *p == '\n';
	t->at = p < t->end ? p + 1 : p;
	while (to > from && (to[-1] == ' ' || to[-1] == '\r'))
		to--;
	*to = 0;
	return from + strspn(from, " ");
}

/* Moves t->at to the next line with content. Returns false at the end. */
static bool next_line(struct text *t)
{
	for (; t->at < t->end; t->line++) {
		char *p = t->at;
		while (p < t->end && (*p == ' ' || *p == '\r' || *p == '\t'))
			p++;
		if (p < t->end && *p != '\n' && *p != '#')
			return true;
		char *newline = memchr(t->at, '\n', (size_t)(t->end - t->at));
		t->at = newline ? newline + 1 : t->end;
	}
	return false;
}

static bool read_head(struct csv_table *table, struct text *t, struct err *err)
{
	if (!next_line(t))
		return err_set(err, "%s: is empty, must have a head line", t->path);
	size_t length = strcspn(t->at, "\n"), comma = strcspn(t->at, ",");
	t->separator = comma < length ? ',' : memchr(t->at, ';', length) ? ';' : memchr(t->at, '\t', length) ? '\t' : ',';
	for (bool last = false; !last;) {
		char *name = next_field(t, &last, err);
		if (!name)
			return false;
		if (!*name || strlen(name) > NAME_MAX_BYTES)
			return err_set(err, "%s:%d: name of column %d: must be 1 to %d bytes", t->path, t->line, table->n_columns + 1,
			               NAME_MAX_BYTES);
		if (csv_column(table, name) >= 0)
			return err_set(err, "%s:%d: column %.50s stands there twice", t->path, t->line, name);
		if (table->n_columns == COLUMNS_MAX)
			return err_set(err, "%s:%d: more than %d columns", t->path, t->line, COLUMNS_MAX);
		table->names = mem_grow(table->names, (size_t)table->n_columns + 1, sizeof *table->names);
		table->names[table->n_columns++] = mem_str(name);
	}
	t->line++;
	return true;
}

static bool number_of(double *out, const char *field)
{
	char *end;
	*out = NAN;
	if (!*field)
		return true;
	*out = strtod(field, &end);
	return !*end && isfinite(*out);
}

static bool read_row(struct csv_table *table, struct text *t, double *row, struct err *err)
{
	int n = 0;
	for (bool last = false; !last; n++) {
		char *field = next_field(t, &last, err);
		if (!field)
			return false;
		if (n == table->n_columns)
			return err_set(err, "%s:%d: more fields than the head's %d", t->path, t->line, table->n_columns);
		if (!number_of(&row[n], field))
			return err_set(err, "%s:%d: %s = %.40s: must be a finite number, or nothing where it was not measured", t->path, t->line, table->names[n], field);
	}
	if (n < table->n_columns)
		return err_set(err, "%s:%d: %d fields, must be %d as in the head", t->path, t->line, n, table->n_columns);
	return true;
}

/* Room doubles when the count of rows reaches a power of two. */
static void append(struct csv_table *table, const double *row, int line)
{
	long n = table->n_rows;
	if (!(n & (n - 1))) {
		size_t room = n ? 2 * (size_t)n : 1;
		table->cell = mem_grow(table->cell, room * (size_t)table->n_columns, sizeof *table->cell);
		table->line = mem_grow(table->line, room, sizeof *table->line);
	}
	memcpy(table->cell + n * table->n_columns, row, (size_t)table->n_columns * sizeof *row);
	table->line[table->n_rows++] = line;
}

bool csv_read(struct csv_table *table, const char *path, struct err *err)
{
	char *bytes;
	size_t size;
	*table = (struct csv_table){ 0 };
	if (!file_read(&bytes, &size, path, bytes_max, err))
		return false;
	struct text t = { path, bytes, bytes + size, ',', 1 };
	if (memchr(bytes, 0, size)) {
		free(bytes);
		return err_set(err, "%s: holds a zero byte: not a text file", path);
	}
	if (size >= 3 && !memcmp(bytes, "\xef\xbb\xbf", 3))
		t.at += 3;
	bool ok = read_head(table, &t, err);
	double *row = mem_array((size_t)table->n_columns + 1, sizeof *row);
	for (; ok && next_line(&t); t.line++)
		if ((ok = read_row(table, &t, row, err)))
			append(table, row, t.line);
	free(row);
	free(bytes);
	return ok;
}

struct csv_table csv_table_new(int n_columns, const char *const names[])
{
	struct csv_table table = { .n_columns = n_columns, .names = mem_new((size_t)n_columns, sizeof *table.names) };
	for (int i = 0; i < n_columns; i++)
		table.names[i] = mem_str(names[i]);
	return table;
}

void csv_add(struct csv_table *table, const double *row)
{
	append(table, row, (int)table->n_rows + 2);
}

static void put_name(FILE *out, const char *name)
{
	bool quote = name[strcspn(name, ",;\t\" #")] != 0;
	for (fputs(quote ? "\"" : "", out); *name; name++)
		fprintf(out, *name == '"' ? "\"\"" : "%c", *name);
	fputs(quote ? "\"" : "", out);
}

bool csv_save(const char *path, const struct csv_table *table, struct err *err)
{
	char *text = 0;
	size_t size = 0;
	FILE *out = open_memstream(&text, &size);
	for (int c = 0; c < table->n_columns; c++) {
		put_name(out, table->names[c]);
		fputc(c + 1 < table->n_columns ? ',' : '\n', out);
	}
	for (long r = 0; r < table->n_rows; r++)
		for (int c = 0; c < table->n_columns; c++) {
			double x = csv_at(table, r, c);
			if (isfinite(x))
				fprintf(out, "%.10g", x == 0 ? 0 : x);  // no "-0"
			else if (table->n_columns == 1)
				fputs("\"\"", out);  // an empty line would be no row
			fputc(c + 1 < table->n_columns ? ',' : '\n', out);
		}
	bool ok = !fclose(out) && file_write(path, text, size, err);
	free(text);
	return ok;
}

void csv_table_free(struct csv_table *table)
{
	for (int i = 0; i < table->n_columns; i++)
		free(table->names[i]);
	free(table->names);
	free(table->cell);
	free(table->line);
	*table = (struct csv_table){ 0 };
}

int csv_column(const struct csv_table *table, const char *name)
{
	for (int i = 0; i < table->n_columns; i++)
		if (!strcmp(table->names[i], name))
			return i;
	return -1;
}

int csv_need(const struct csv_table *table, const char *name, const char *path, struct err *err)
{
	int c = csv_column(table, name);
	if (c < 0)
		err_set(err, "%s: no column %s", path, name);
	return c;
}

bool csv_in_range(const struct csv_table *table, int column, double low, double high, const char *path, struct err *err)
{
	for (long r = 0; r < table->n_rows && column >= 0; r++) {
		const double x = csv_at(table, r, column);
		if (x < low || x > high)
			return err_set(err, "%s:%d: %s = %g: must be in [%g, %g]", path, table->line[r], table->names[column], x, low, high);
	}
	return true;
}
