/* capture.conf: read, then resolved against a table with every kind of option. */
#include "tests/fuzz/fuzz.h"

#include <string.h>

#include "base/conf.h"
#include "base/mem.h"
#include "base/opt.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static const char *const names[] = { "red", "green", 0 };
	double real, reals[3];
	int integer, choice;
	bool yes;
	const char *text;
	struct opt_each_list each = { 0 };
	const struct opt opts[] = {
		OPT_REAL("a", &real, 0, 1, "mm", ""),      OPT_INT("b", &integer, 0, 9, "", ""),
		OPT_BOOL("c", &yes, ""),                   OPT_CHOICE("d", &choice, names, ""),
		OPT_REALS("e", &reals[0], 3, -1, 1, "", ""), OPT_STR("f", &text, ""),
		OPT_EACH("photo.*.g", &each, 2, 0, 1, "", ""),
	};
	struct conf conf = { 0 };
	struct err err = { 0 };
	for (int i = 0; i < COUNT(opts) - 1; i++) {
		static const char *const defaults[] = { "0.5", "1", "no", "red", "0 0 0", "" };
		char key[] = { 's', '.', (char)('a' + i), 0 };
		conf_add(&conf, key, defaults[i]);
		conf.items[i].layer = 0;
	}
	if (conf_load(&conf, fuzz_file(data, size), "", 1, &err) && opt_resolve("s", COUNT(opts), opts, &conf, &err)
	    && !(real >= 0 && real <= 1 && integer >= 0 && integer <= 9 && choice >= 0 && choice < 2))
		abort();  // out of range and accepted
	if (strchr(err.msg, '\n'))
		abort();
	opt_free(COUNT(opts), opts);
	conf_free(&conf);
	return 0;
}
