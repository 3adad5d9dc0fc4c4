/* fronts.conf and what capture.conf asks of it, a form feed between them: read, and a setting chosen for each stage. */
#include "tests/fuzz/fuzz.h"

#include <math.h>
#include <string.h>

#include "base/front.h"
#include "base/mem.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static const char *const stages[] = { "plan", "blur", "paint" };
	const uint8_t *cut = memchr(data, '\f', size), *ask_at = cut ? cut + 1 : data + size;
	struct front front = { 0 };
	struct front_ask ask;
	struct conf conf = { 0 };
	struct err err = { 0 };
	int chosen[3];
	bool ok = front_load(&front, fuzz_file(data, (size_t)(cut ? cut - data : (long)size)), &err);
	ok = ok && conf_load(&conf, fuzz_file(ask_at, (size_t)(data + size - ask_at)), "", 1, &err) && front_ask(&ask, &conf, &err);
	if (ok) {
		front_choose(&front, &ask, 3, stages, (const bool[]){ true, true, true }, 2, 0.86, 1, chosen);
		for (int s = 0; s < 3; s++)
			if (chosen[s] < -1 || chosen[s] >= front.n || (chosen[s] >= 0 && strcmp(front.points[chosen[s]].stage, stages[s]) != 0))
				abort();  // another stage's setting, or none there is
		for (int i = 0; i < front.n; i++)
			if (!(front.points[i].error >= 0) || isnan(front_seconds(&front.points[i], 2, 0.86)))
				abort();
	} else if (!err_is(&err) || strchr(err.msg, '\n')) {
		abort();  // refused without a line, or in several
	}
	front_free(&front);
	conf_free(&conf);
	return 0;
}
