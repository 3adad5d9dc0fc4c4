/* csv: the files that bench.c writes (RFC 4180), read back. */
#ifndef TESTS_CSV_H
#define TESTS_CSV_H
#include "base/err.h"

enum { CSV_COLUMNS = 11 };

struct csv_row {
	char *cell[CSV_COLUMNS];  // "" where the line is shorter
};

struct csv {
	struct csv_row *rows;  // without the head line
	int n;
};

bool csv_load(struct csv *csv, const char *path, struct err *err);
void csv_free(struct csv *csv);

/* The number in a cell; NAN where it is empty. */
double csv_number(const char *cell);

#endif
