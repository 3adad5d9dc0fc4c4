/* Configuration: layers, presets, and errors that name file, line, key, value and rule. */
#include "tests/lib/unit.h"

#include "base/conf.h"
#include "base/file.h"
#include "base/opt.h"
#include "tests/lib/scratch.h"

struct values {
	double sigma, three[3], unset;
	int count, choice;
	bool yes;
	const char *text;
	struct opt_each_list hints;
};

static const char *const colours[] = { "red", "green", 0 };

enum { ROWS = 8 };
static void table(struct opt opts[ROWS], struct values *v)
{
	struct opt rows[ROWS] = {
		OPT_REAL("sigma", &v->sigma, 0.3, 10, "px", "blur"),
		OPT_INT("count", &v->count, 1, 100, "", "how many"),
		OPT_BOOL("yes", &v->yes, "whether"),
		OPT_CHOICE("choice", &v->choice, colours, "which"),
		OPT_REALS("three", &v->three[0], 3, -1, 1, "mm", "a point"),
		OPT_REAL_UNSET("eye.unset", &v->unset, 0, 1, "", "may be empty"),
		OPT_STR("text", &v->text, "words"),
		OPT_EACH("photo.*.hint", &v->hints, 2, 0, 100, "px", "where"),
	};
	memcpy(opts, rows, sizeof rows);
}

#define DEFAULTS "sigma = 2\nsigma.draft = 4\ncount = 5\nyes = no\nchoice = red\nthree = 0 0.5 -1\ntext =\n"
#define SHARED "quality = review\neye.unset =\nphoto.*.hint =\n"

/* Loads the defaults and this capture.conf; fills v. */
static bool resolve(struct values *v, struct conf *conf, const char *capture, struct err *err)
{
	struct opt opts[ROWS];
	table(opts, v);
	*conf = (struct conf){ 0 };
	const char *shared = scratch_text("shared.conf", SHARED), *own = scratch_text("own.conf", DEFAULTS);
	const char *path = scratch_text("capture.conf", capture);
	return conf_load(conf, shared, "", 0, err) && conf_load(conf, own, "stage.", 0, err)
	       && conf_load(conf, path, "", 1, err) && opt_resolve("stage", ROWS, opts, conf, err);
}

static void finish(struct values *v, struct conf *conf)
{
	struct opt opts[ROWS];
	table(opts, v);
	opt_free(ROWS, opts);
	conf_free(conf);
}

static void defaults_presets_and_overrides(void **state)
{
	(void)state;
	struct values v = { 0 };
	struct conf conf;
	struct err err = { 0 };
	assert_true(resolve(&v, &conf, "", &err));
	assert_true(v.sigma == 2 && v.count == 5 && !v.yes && v.choice == 0 && v.three[1] == 0.5 && !v.text);
	assert_true(isnan(v.unset));
	finish(&v, &conf);
	assert_true(resolve(&v, &conf, "quality = draft\n", &err));
	assert_true(v.sigma == 4);  // the preset
	finish(&v, &conf);
	assert_true(resolve(&v, &conf, "quality = draft\nstage.sigma = 3\nstage.text = a b\nphoto.x.y.hint = 1 2\n", &err));
	assert_true(v.sigma == 3);  // what the user says goes before any preset
	assert_string_equal(v.text, "a b");
	assert_int_equal(v.hints.n, 1);
	assert_string_equal(v.hints.items[0].name, "x.y");
	assert_true(v.hints.items[0].value[1] == 2);
	finish(&v, &conf);
}

static void command_line_wins(void **state)
{
	(void)state;
	struct values v = { 0 };
	struct conf conf = { 0 };
	struct err err = { 0 };
	struct opt opts[ROWS];
	table(opts, &v);
	conf_add(&conf, "stage.sigma", "7");
	assert_true(conf_load(&conf, scratch_text("shared.conf", SHARED), "", 0, &err));
	assert_true(conf_load(&conf, scratch_text("own.conf", DEFAULTS), "stage.", 0, &err));
	assert_true(conf_load(&conf, scratch_text("capture.conf", "stage.sigma = 3\n"), "", 1, &err));
	assert_true(opt_resolve("stage", ROWS, opts, &conf, &err));
	assert_true(v.sigma == 7);
	opt_free(ROWS, opts);
	conf_free(&conf);
}

/* capture.conf and what the one line about it has to say. */
static const struct {
	const char *text, *says[4];
} faults[] = {
	{ "\n\nstage.sigma = 25\n", { "capture.conf:3", "sigma = 25", "[0.3, 10]", "px" } },
	{ "stage.sigma = 2x\n", { "capture.conf:1", "sigma = 2x", "number" } },
	{ "stage.sigma = nan\n", { "capture.conf:1", "sigma = nan" } },
	{ "stage.sigma = 1e999\n", { "capture.conf:1", "sigma = 1e999" } },
	{ "stage.sigma =\n", { "capture.conf:1", "sigma", "needs a value" } },
	{ "stage.count = 2.5\n", { "count = 2.5", "whole number", "[1, 100]" } },
	{ "stage.yes = true\n", { "yes = true", "yes or no" } },
	{ "stage.choice = blue\n", { "choice = blue", "red green" } },
	{ "stage.three = 0 0\n", { "three = 0 0", "3 of them" } },
	{ "stage.three = 0 0 0 0\n", { "three = 0 0 0 0", "3 of them" } },
	{ "stage.sgima = 2\n", { "capture.conf:1", "stage.sgima = 2", "unknown key" } },
	{ "stage.sigma.draft = 2\n", { "capture.conf:1", "unknown key" } },
	{ "stage.sigma = 1\nstage.sigma = 2\n", { "capture.conf:2", "given twice", "line 1" } },
	{ "no equals sign\n", { "capture.conf:1", "key = value" } },
	{ "[section]\nsigma = 2\n", { "capture.conf:2", "sections" } },
	{ "photo.a.hint = 1\n", { "capture.conf:1", "2 of them" } },
	{ "photo.a.hint = 1 101\n", { "capture.conf:1", "[0, 100]" } },
};

/* A line of `size` bytes in all: "stage.text = aa a aaa..." and, where it has room for them, a comment. */
static void line_of(char *to, size_t size, const char *key, const char *comment)
{
	size_t head = (size_t)sprintf(to, "%s = ", key), tail = strlen(comment);
	for (size_t i = head; i < size - tail; i++)
		to[i] = i % 3 && i > head && i + 1 < size - tail ? ' ' : (char)('a' + i % 26);
	strcpy(to + size - tail, comment);
}

/* A line is read whole up to 1000 bytes, whatever inih's own buffer holds; a longer one is refused by file, line and rule. */
static void long_lines(void **state)
{
	(void)state;
	for (size_t size = 150; size <= 1000; size += size < 300 ? 1 : 50)
		for (int comment = 0; comment < 2; comment++) {
			char line[1100], text[2300];
			struct conf conf = { 0 };
			struct err err = { 0 };
			line_of(line, size, "stage.text", comment ? "  ; it has = one: too" : "");
			snprintf(text, sizeof text, "; %0*d\n%s\r\nstage.count = 3", (int)size - 2, 0, line);
			bool fits = size < 1000;  // the carriage return is one byte more
			assert_int_equal(conf_load(&conf, scratch_text("long.conf", text), "", 1, &err), fits);
			if (fits) {
				size_t n = size - strlen("stage.text = ") - (comment ? strlen("  ; it has = one: too") : 0);
				const struct conf_item *item = conf_find(&conf, "stage.text", 0);
				assert_int_equal(strlen(item->value), n);
				assert_memory_equal(item->value, line + strlen("stage.text = "), n);
				assert_int_equal(item->line, 2);
				assert_int_equal(conf_find(&conf, "stage.count", 0)->line, 3);
			} else
				ERR_HAS(err, "long.conf:2: line of 1001 bytes, must be <= 1000");
			conf_free(&conf);
		}
}

/* Long lines that are wrong: what the one line about them has to say. */
static void long_faults(void **state)
{
	(void)state;
	char text[3000], words[601];
	memset(words, 'x', 600);
	words[600] = 0;
	const struct {
		const char *head, *tail, *says;
	} cases[] = {
		{ "\n", "\n", "bad.conf:2: not of the form key = value" },
		{ "\n[", "]\na = 1\n", "bad.conf:2: not of the form key = value" },
		{ "a = 1\na = ", "\n", "bad.conf:2: a: given twice, first in line 1" },
		{ "", "= 1\n", "bad.conf:1: key of 600 bytes, must be <= " },
		{ "b = ", "", 0 },
		{ "   b = ", "  ", 0 },
	};
	for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
		struct conf conf = { 0 };
		struct err err = { 0 };
		snprintf(text, sizeof text, "%s%s%s", cases[i].head, words, cases[i].tail);
		assert_int_equal(conf_load(&conf, scratch_text("bad.conf", text), "", 1, &err), !cases[i].says);
		if (cases[i].says)
			ERR_HAS(err, cases[i].says);
		else
			assert_string_equal(conf_find(&conf, "b", 0)->value, words);
		conf_free(&conf);
	}
}

static void faults_name_place_value_and_rule(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof faults / sizeof *faults; i++) {
		struct values v = { 0 };
		struct conf conf;
		struct err err = { 0 };
		if (resolve(&v, &conf, faults[i].text, &err))
			fail_msg("accepted: %s", faults[i].text);
		for (int k = 0; k < 4 && faults[i].says[k]; k++)
			ERR_HAS(err, faults[i].says[k]);
		assert_null(strchr(err.msg, '\n'));
		finish(&v, &conf);
	}
}

static void hostile_files_are_refused(void **state)
{
	(void)state;
	struct conf conf = { 0 };
	struct err err = { 0 };
	assert_false(conf_load(&conf, scratch_write("zero.conf", "a = 1\0b", 7), "", 1, &err));
	ERR_HAS(err, "zero byte");
	err = (struct err){ 0 };
	char line[2100];
	memset(line, 'x', sizeof line);
	memcpy(line, "a = ", 4);
	line[sizeof line - 1] = '\n';
	assert_false(conf_load(&conf, scratch_write("long.conf", line, sizeof line), "", 1, &err));
	ERR_HAS(err, "long.conf:1");
	err = (struct err){ 0 };
	assert_true(conf_load(&conf, scratch_path("none.conf"), "", 1, &err));  // an empty capture.conf and none are one
	assert_false(conf_load(&conf, scratch_path("none.conf"), "", 0, &err));
	conf_free(&conf);
}

static void slice_is_sorted_and_effective(void **state)
{
	(void)state;
	struct values v = { 0 };
	struct conf conf;
	struct err err = { 0 };
	struct opt opts[ROWS];
	char *text;
	size_t size;
	assert_true(resolve(&v, &conf, "quality = draft\nphoto.b.hint = 1 2\nother.key = 3\n", &err));
	table(opts, &v);
	FILE *f = open_memstream(&text, &size);
	opt_print(f, "stage", ROWS, opts, &conf);
	fclose(f);
	assert_string_equal(text, "eye.unset = \nphoto.b.hint = 1 2\nstage.choice = red\nstage.count = 5\nstage.sigma = 4\n"
	                          "stage.text = \nstage.three = 0 0.5 -1\nstage.yes = no\n");
	free(text);
	finish(&v, &conf);
}

static void patterns(void **state)
{
	(void)state;
	char *name;
	assert_true(opt_match("photo.*.eye", "photo.a.b.eye", &name));
	assert_string_equal(name, "a.b");
	free(name);
	assert_false(opt_match("photo.*.eye", "photo..eye", &name));
	assert_false(opt_match("photo.*.eye", "photo.eye", &name));
	assert_true(opt_match("a.b", "a.b", &name));
	assert_false(opt_match("a.b", "a.bc", 0));
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		SCRATCH_TEST(defaults_presets_and_overrides),
		SCRATCH_TEST(command_line_wins),
		SCRATCH_TEST(faults_name_place_value_and_rule),
		SCRATCH_TEST(hostile_files_are_refused),
		SCRATCH_TEST(slice_is_sorted_and_effective),
		SCRATCH_TEST(long_lines),
		SCRATCH_TEST(long_faults),
		cmocka_unit_test(patterns),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
