#include "tests/lib/bench/csv.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"

/* One cell from *at, which moves behind it and its comma; quotes undone. */
static char *take_cell(const char **at)
{
	const char *p = *at;
	char *cell = mem_new(strlen(p) + 1, 1), *to = cell;
	bool quoted = *p == '"';
	p += quoted;
	while (*p && (quoted || (*p != ',' && *p != '\n'))) {
		if (quoted && *p == '"') {
			if (p[1] != '"') {
				p++;
				break;
			}
			p++;
		}
		*to++ = *p++;
	}
	*at = p + (*p == ',');
	return cell;
}

bool csv_load(struct csv *csv, const char *path, struct err *err)
{
	char *text;
	size_t size;
	*csv = (struct csv){ 0 };
	if (!file_read(&text, &size, path, 1 << 26, err))
		return false;
	const char *at = strchrnul(text, '\n');
	while (*at && *++at) {
		csv->rows = mem_grow(csv->rows, (size_t)csv->n + 1, sizeof *csv->rows);
		struct csv_row *row = &csv->rows[csv->n++];
		for (int c = 0; c < CSV_COLUMNS; c++)
			row->cell[c] = take_cell(&at);
		at = strchrnul(at, '\n');
	}
	free(text);
	return true;
}

void csv_free(struct csv *csv)
{
	for (int i = 0; i < csv->n; i++)
		for (int c = 0; c < CSV_COLUMNS; c++)
			free(csv->rows[i].cell[c]);
	free(csv->rows);
	*csv = (struct csv){ 0 };
}

double csv_number(const char *cell)
{
	return *cell ? strtod(cell, 0) : NAN;
}
