#include "model/gaze_table.h"

#include <ctype.h>
#include <string.h>

#include "base/mem.h"

const char *const gaze_columns[10] = { "g1_deg", "g2_deg", "g3_deg", "g4_px", "g5_px", "g6_deg", "g7_deg", "g8_deg", "g9_px", "g10_px" };

/* Columns by what stands before their number and behind it. Bounds that no measurement reaches: a video's picture has 65535 px at most,
 * a strength beyond its peak frame's grows past 1. */
static const struct {
	const char *before, *behind;
	double low, high;
} kinds[] = {
	{ "g", "_deg", -180, 180 }, { "g", "_px", -65536, 65536 }, { "a", "", -100, 100 }, { "au", "", -100, 100 },
};

/* "g4_px" is "g", a number, "_px". */
static bool is_kind(const char *name, const char *before, const char *behind)
{
	const size_t n = strlen(before);
	if (strncmp(name, before, n) || !isdigit((unsigned char)name[n]))
		return false;
	const char *end = name + n + strspn(name + n, "0123456789");
	return !strcmp(end, behind);
}

bool gaze_table_check(const struct csv_table *table, const char *path, struct err *err)
{
	for (int c = 0; c < table->n_columns; c++)
		for (int k = 0; k < COUNT(kinds); k++)
			if (is_kind(table->names[c], kinds[k].before, kinds[k].behind)
			    && !csv_in_range(table, c, kinds[k].low, kinds[k].high, path, err))
				return false;
	return csv_in_range(table, csv_column(table, "confidence_left"), 0, 1, path, err)
	       && csv_in_range(table, csv_column(table, "confidence_right"), 0, 1, path, err);
}
