/* csv: tables of numbers with named columns. An empty field is NAN. Written with %.10g, one head line, no comment.
 * Read: comma, semicolon or tab between fields (what the head line has), CRLF, a byte-order mark, quotes round fields,
 * empty lines and lines that begin with # are all taken. A field that is no number, a row of another length than the
 * head, a column named twice, are refused with file and line.
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

/* csv_table_free in any case. */
bool csv_read(struct csv_table *table, const char *path, struct err *err);

/* n_columns names; no row yet. */
struct csv_table csv_table_new(int n_columns, const char *const names[]);

/* Appends a row of n_columns numbers. */
void csv_add(struct csv_table *table, const double *row);

bool csv_save(const char *path, const struct csv_table *table, struct err *err);
void csv_table_free(struct csv_table *table);

/* Index of that column; -1 when there is none. */
int csv_column(const struct csv_table *table, const char *name);

/* The same; err names path and column when there is none. */
int csv_need(const struct csv_table *table, const char *name, const char *path, struct err *err);

static inline double csv_at(const struct csv_table *table, long row, int column)
{
	return column < 0 ? __builtin_nan("") : table->cell[row * table->n_columns + column];
}

#endif
