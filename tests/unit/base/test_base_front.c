/* Settings from measured fronts: what is asked for, what is chosen, what reaches the stage, and what is refused. */
#include "tests/lib/unit.h"

#include "base/call.h"
#include "base/file.h"
#include "base/front_use.h"
#include "base/opt.h"
#include "tests/lib/scratch.h"

#define FRONTS "blur.fast = 0.4 mm, 0.1 s + 0.1 s/Mpx: sigma = 4, steps = 2\n" \
	"blur.middle = 0.1 mm, 0.2 s + 0.2 s/Mpx: sigma = 2, steps = 4\n" \
	"blur.exact = 0.01 mm, 1 s + 1 s/Mpx: sigma = 1, steps = 9\n" \
	"paint.rough = 8 %, 0.5 s + 0 s/Mpx: rays = 1\n" \
	"paint.fine = 1 %, 1 s + 0 s/Mpx: rays = 8\n"

static const char *const stages[] = { "plan", "blur", "paint", "other" };
static const bool all_run[] = { true, true, true, true };

static int setup(void **state)
{
	scratch_setup(state);
	scratch_text("config/fronts.conf", FRONTS);
	scratch_text("config/capture.conf", "quality = review\nerror =\ntime =\n");
	scratch_text("config/blur.conf", "sigma = 3\nsigma.draft = 5\nsteps = 3\n");
	scratch_text("config/plan.conf", "");
	return 0;
}

/* What plan chooses for this capture.conf, by name; "-" for none. */
static const char *choose(const char *capture, const bool runs[4], double mpx, double others_s)
{
	static char said[100];
	struct conf conf = { 0 };
	struct front front;
	struct front_ask ask;
	struct err err = { 0 };
	int chosen[4];
	bool changed;
	assert_true(conf_load(&conf, scratch_path("config/capture.conf"), "", 0, &err));
	assert_true(conf_load(&conf, scratch_text("capture.conf", capture), "", 1, &err));
	assert_true(front_load(&front, scratch_path("config/fronts.conf"), &err) && front_ask(&ask, &conf, &err));
	front_choose(&front, &ask, 4, stages, runs, mpx, 0, others_s, chosen);
	snprintf(said, sizeof said, "%s %s", chosen[1] < 0 ? "-" : front.points[chosen[1]].name,
	         chosen[2] < 0 ? "-" : front.points[chosen[2]].name);
	assert_true(chosen[0] < 0 && chosen[3] < 0);
	assert_true(front_save(&front, &ask, 4, chosen, scratch_path("."), &changed, &err));
	front_free(&front);
	conf_free(&conf);
	return said;
}

static void an_error_takes_the_fastest_that_is_as_exact(void **state)
{
	(void)state;
	assert_string_equal(choose("error = 0.5 mm\n", all_run, 1, 0), "fast -");
	assert_string_equal(choose("error = 0.4 mm\n", all_run, 1, 0), "fast -");
	assert_string_equal(choose("error = 0.39 mm\n", all_run, 1, 0), "middle -");
	assert_string_equal(choose("error = 0.02 mm\n", all_run, 1, 0), "exact -");
	assert_string_equal(choose("error = 0.0001 mm\n", all_run, 1, 0), "exact -");  // the best there is
	assert_string_equal(choose("error = 2 %\n", all_run, 1, 0), "- fine");
	assert_string_equal(choose("error = 1 furlong\n", all_run, 1, 0), "- -");
	assert_string_equal(choose("error = 0.5 mm\n", (const bool[]){ true, false, true, true }, 1, 0), "- -");
}

static void a_time_is_spent_where_it_helps_most(void **state)
{
	(void)state;
	// At 1 Mpx: 0.2, 0.4 and 2 s for blur, 0.5 and 1 s for paint. A factor of 4 for 0.2 s, of 8 for 0.5 s, of 10 for 1.6 s.
	assert_string_equal(choose("time = 100 ms\n", all_run, 1, 0), "fast rough");  // the least there is
	assert_string_equal(choose("time = 0.95 s\n", all_run, 1, 0), "middle rough");
	assert_string_equal(choose("time = 1.45 s\n", all_run, 1, 0), "middle fine");
	assert_string_equal(choose("time = 1 min\n", all_run, 1, 0), "exact fine");
	assert_string_equal(choose("time = 1 min\n", all_run, 1, 59), "middle rough");  // other stages take 59 s of it
	assert_string_equal(choose("time = 1.45 s\n", all_run, 10, 0), "fast rough");  // of ten megapixels everything takes longer
	assert_string_equal(choose("time = 1.45 s\n", (const bool[]){ true, false, true, true }, 10, 0), "- fine");
}

struct values {
	double sigma, steps;
};

static bool stage_reads(struct values *v, const char *capture, struct err *err)
{
	struct conf conf = { 0 };
	struct call call = { .capture = scratch_path("."), .config_dir = scratch_path("config") };
	const struct opt opts[] = { OPT_REAL("sigma", &v->sigma, 0, 10, "px", "blur"), OPT_REAL("steps", &v->steps, 0, 10, "", "steps") };
	scratch_text("capture.conf", capture);
	bool ok = call_load(&call, "blur", &conf, err) && opt_resolve("blur", 2, opts, &conf, err);
	conf_free(&conf);
	return ok;
}

static void the_stage_reads_what_was_chosen(void **state)
{
	(void)state;
	struct values v;
	struct err err = { 0 };
	choose("error = 0.1 mm\n", all_run, 1, 0);
	assert_true(stage_reads(&v, "error = 0.1 mm\n", &err) && v.sigma == 2 && v.steps == 4);
	assert_true(stage_reads(&v, "error = 0.1 mm\nblur.sigma = 7\n", &err) && v.sigma == 7 && v.steps == 4);  // a key goes before
	assert_true(stage_reads(&v, "quality = draft\n", &err) && v.sigma == 5 && v.steps == 3);
	assert_true(stage_reads(&v, "", &err) && v.sigma == 3 && v.steps == 3);
	// Another question than plan has answered.
	assert_false(stage_reads(&v, "error = 0.2 mm\n", &err));
	assert_non_null(strstr(err.msg, "error = 0.2 mm: no setting is chosen yet"));
	// No front in this unit: the preset review.
	choose("error = 2 %\n", all_run, 1, 0);
	err = (struct err){ 0 };
	assert_true(stage_reads(&v, "error = 2 %\n", &err) && v.sigma == 3);
}

static void settings_too_long_for_a_line_go_on_in_the_next(void **state)
{
	(void)state;
	struct values v;
	struct front front;
	struct err err = { 0 };
	scratch_text("config/fronts.conf", "blur.fast = 0.4 mm, 0.1 s + 0.1 s/Mpx: sigma = 4\n" "blur.exact = 0.01 mm, 1 s + 1 s/Mpx: sigma = 1\n"
	                                   "blur.exact.more = steps = 7\n");
	assert_string_equal(choose("error = 0.1 mm\n", all_run, 1, 0), "exact -");
	assert_true(stage_reads(&v, "error = 0.1 mm\n", &err) && v.sigma == 1 && v.steps == 7);
	assert_string_equal(choose("error = 0.5 mm\n", all_run, 1, 0), "fast -");
	assert_true(stage_reads(&v, "error = 0.5 mm\n", &err) && v.sigma == 4 && v.steps == 3);
	assert_true(front_load(&front, scratch_path("config/fronts.conf"), &err) && front.n == 2);
	front_free(&front);
}

static void nonsense_is_refused_in_one_line(void **state)
{
	(void)state;
	static const struct {
		const char *text, *says;
	} cases[] = {
		{ "error = 0.05\n", "capture.conf:1: error = 0.05: must be an error with its unit" },
		{ "error = -1 mm\n", "error = -1 mm: must be" },
		{ "error = nan mm\n", "error = nan mm: must be" },
		{ "error = 0 mm\n", "error = 0 mm: must be" },
		{ "error = 1 mm or so\n", "must be an error" },
		{ "time = 3\n", "capture.conf:1: time = 3: must be a time" },
		{ "time = inf s\n", "must be a time" },
		{ "time = 3 moons\n", "must be a time" },
		{ "time = s\n", "must be a time" },
		{ "\ntime = 2 s\nerror = 1 mm\n", "capture.conf:3: error = 1 mm: time is given too" },
		{ "quality = draft\ntime = 2 s\n", "capture.conf:2: time = 2 s: quality is given too" },
		{ "fronts.blur = 1\n", "fronts.blur = 1: unknown key" },
	};
	for (int i = 0; i < (int)(sizeof cases / sizeof *cases); i++) {
		struct values v;
		struct err err = { 0 };
		assert_false(stage_reads(&v, cases[i].text, &err));
		if (!strstr(err.msg, cases[i].says) || strchr(err.msg, '\n'))
			fail_msg("%s says: %s", cases[i].text, err.msg);
	}
}

static void a_damaged_file_of_fronts_is_refused(void **state)
{
	(void)state;
	static const char *const bad[] = { "blur.fast = 0.4 mm\n", "blur.fast = mm, 1 s + 1 s/Mpx: a = 1\n", "fast = 0.4 mm, 1 s + 1 s/Mpx: a = 1\n",
		                           "blur.fast = 0.4 mm, -1 s + 1 s/Mpx: a = 1\n", "blur.fast = nan mm, 1 s + 1 s/Mpx: a = 1\n", "blur.fast.more = a = 1\n", "..more = a = 1\n" };
	for (int i = 0; i < (int)(sizeof bad / sizeof *bad); i++) {
		struct front front;
		struct err err = { 0 };
		assert_false(front_load(&front, scratch_text("bad.conf", bad[i]), &err));
		assert_non_null(strstr(err.msg, "bad.conf:1: "));
		front_free(&front);
	}
}

/* Those of this project: every stage's settings are keys that it has, and none is beaten by another of the same stage. */
static void the_recorded_fronts_are_fronts(void **state)
{
	(void)state;
	struct front front;
	struct err err = { 0 };
	assert_true(front_load(&front, "config/fronts.conf", &err));
	assert_true(front.n > 0);
	for (int i = 0; i < front.n; i++)
		for (int k = 0; k < front.n; k++) {
			const struct front_point *a = &front.points[i], *b = &front.points[k];
			if (strcmp(a->stage, b->stage) || i == k)
				continue;
			assert_string_equal(a->unit, b->unit);
			// Two megapixels: what it is measured on. A tenth: the spread of its times.
			if (a->error < 0.98 * b->error && front_seconds(a, 2, 0.86) < 0.9 * front_seconds(b, 2, 0.86))
				fail_msg("%s.%s is beaten by %s", b->stage, b->name, a->name);
		}
	front_free(&front);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(an_error_takes_the_fastest_that_is_as_exact, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(a_time_is_spent_where_it_helps_most, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(the_stage_reads_what_was_chosen, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(settings_too_long_for_a_line_go_on_in_the_next, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(nonsense_is_refused_in_one_line, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(a_damaged_file_of_fronts_is_refused, setup, scratch_teardown),
		cmocka_unit_test(the_recorded_fronts_are_fronts),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
