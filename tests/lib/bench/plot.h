/* plot: error against time, one picture for each table of a benchmark and each kind of error. */
#ifndef TESTS_PLOT_H
#define TESTS_PLOT_H
#include "tests/lib/bench/csv.h"

/* Columns of bench/NAME.csv. */
enum { TABLE, METHOD, SETTING, PER, MEDIAN, LOW, HIGH, ERROR, UNIT, ERROR_OF };

bool csv_same(const struct csv_row *a, const struct csv_row *b, int column);

/* Whether both rows belong in one picture: table, kind of error and its unit. */
bool plot_shares(const struct csv_row *a, const struct csv_row *b);

/* Whether the row has a time and an error. */
bool plot_has(const struct csv_row *r);

/* All rows that share a picture with `head`, through gnuplot. False when that fails. */
bool plot_write(const struct csv *csv, const struct csv_row *head, const char *png);

#endif
