/* Tables of numbers; what was read is written and read again. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "base/csv.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct err err = { 0 };
	struct csv_table table;
	bool ok = csv_read(&table, fuzz_file(data, size), &err);
	if (strchr(err.msg, '\n') || (ok && err_is(&err)))
		abort();
	for (long r = 0; ok && r < table.n_rows; r++)
		for (int c = 0; c < table.n_columns; c++)
			if (csv_at(&table, r, c) - csv_at(&table, r, c) != 0 && csv_at(&table, r, c) == csv_at(&table, r, c))
				abort();  // infinite and accepted
	csv_table_free(&table);
	return 0;
}
