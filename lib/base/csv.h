/* csv: tables of numbers with named columns. An empty field is NAN.
 * Written: one head line, numbers with %.10g, commas, no comment.
 * Read: fields separated by comma, semicolon or tab (whichever the head line has); CRLF, a byte-order mark, quotes round fields,
 * empty lines and comment lines (#) are accepted. A field that is no number ("nan" is none), a row of another length than the head, and a column
 * named twice are errors that name file and line.
 */
#ifndef BASE_CSV_H
#define BASE_CSV_H
#include "base/err.h"

struct csv_table {
	int n_columns;
	char **names;
	long n_rows;
	double *cell;  // [n_rows][n_columns]
	int *line;     // [n_rows] of the file, from 1
};

/* Reads a file. Returns false, err set, when it cannot be read or is malformed; csv_table_free in any case. */
bool csv_read(struct csv_table *table, const char *path, struct err *err);

/* An empty table with columns names[n_columns], which are copied. csv_table_free. */
struct csv_table csv_table_new(int n_columns, const char *const names[]);

/* Appends row[n_columns]. */
void csv_add(struct csv_table *table, const double *row);

/* Writes the table beside `path` and renames. Returns false, err set, when it cannot be written. */
bool csv_save(const char *path, const struct csv_table *table, struct err *err);
void csv_table_free(struct csv_table *table);

/* Returns the index of that column, or -1. */
int csv_column(const struct csv_table *table, const char *name);

/* As csv_column; where there is none, err names path and column. */
int csv_need(const struct csv_table *table, const char *name, const char *path, struct err *err);

/* Whether every number of that column, which may be -1, is in [low, high] or missing; if not, err: "path:line: name = number: must ...". */
bool csv_in_range(const struct csv_table *table, int column, double low, double high, const char *path, struct err *err);

/* The number in that row and column; NAN for column -1. */
static inline double csv_at(const struct csv_table *table, long row, int column)
{
	return column < 0 ? __builtin_nan("") : table->cell[row * table->n_columns + column];
}

#endif
