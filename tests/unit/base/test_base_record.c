/* Records: a stage has to run again when, and only when, bytes it depends on have changed. */
#include "tests/lib/unit.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>

#include "base/aside.h"
#include "base/asked.h"
#include "base/conf.h"
#include "base/file.h"
#include "base/mem.h"
#include "base/record_holds.h"
#include "base/record_leave.h"
#include "base/record_left.h"
#include "tests/lib/scratch.h"

static const char *const inputs[] = { "photos/a.jpg" };
static const char out[] = "work/out.json";

static int made;  // files that make_of has made

static int setup(void **state)
{
	scratch_setup(state);
	scratch_text("program", "program 1");
	scratch_text("defaults", "sigma = 2\nsigma.draft = 4\n");
	scratch_text("shared", "quality = review\nphoto.*.hint =\nview.*.mm =\neye.index = 1.336\n");
	scratch_text("capture.conf", "");
	scratch_text("photos/a.jpg", "picture");
	return 0;
}

static struct conf load_conf(void)
{
	struct conf conf = { 0 };
	struct err err = { 0 };
	assert_true(conf_load(&conf, scratch_path("shared"), "", 0, &err)
	            && conf_load(&conf, scratch_path("defaults"), "stage.", 0, &err)
	            && conf_load(&conf, scratch_path("capture.conf"), "", 1, &err));
	return conf;
}

/* A stage's run with the configuration "stage.sigma = 2". */
static void run_stage(const char *config)
{
	struct err err = { 0 };
	struct file_list list;
	char hash[33];
	struct record *r = record_open(scratch_path("."), "stage", scratch_path("program"), config);
	assert_true(file_list(&list, scratch_path("photos"), &err));
	record_listing_hash(hash, list.n, list.names);
	record_list(r, "photos", hash);
	record_each(r, "photo.*.hint");
	file_list_free(&list);
	if (!record_fresh(r, out, 1, inputs)) {
		scratch_text(out, "made");
		record_made(r, out, 1, inputs);
	}
	assert_true(record_save(r, true, &err));
	record_free(r);
}

static bool holds(const char *because)
{
	struct conf conf = load_conf();
	char *why = 0;
	bool fresh = record_holds(scratch_path("."), "stage", scratch_path("program"), &conf, &why);
	if (because && (!why || !strstr(why, because)))
		fail_msg("says \"%s\", must say \"%s\"", why ? why : "", because);
	free(why);
	conf_free(&conf);
	return fresh;
}

#define CONFIG "quality = review\nstage.sigma = 2\n"

static void nothing_changed(void **state)
{
	(void)state;
	assert_false(holds("never run"));
	run_stage(CONFIG);
	assert_true(holds(0));
	// A new date on the same bytes is no change.
	struct timespec times[2] = { { 1e9, 0 }, { 1e9, 0 } };
	assert_int_equal(utimensat(AT_FDCWD, scratch_path("photos/a.jpg"), times, 0), 0);
	assert_int_equal(utimensat(AT_FDCWD, scratch_path("program"), times, 0), 0);
	assert_true(holds(0));
	assert_true(holds(0));
}

static void bytes_changed(void **state)
{
	(void)state;
	run_stage(CONFIG);
	scratch_text("photos/a.jpg", "another");
	assert_false(holds("photos/a.jpg has changed"));
	scratch_text("photos/a.jpg", "picture");
	assert_true(holds(0));
	scratch_text("program", "program 2");
	assert_false(holds("program has changed"));
	scratch_text("program", "program 1");
	scratch_text(out, "mad");
	assert_false(holds("out.json has changed"));
	unlink(scratch_path("%s", out));
	assert_false(holds("out.json is missing"));
}

/* Same length, same inode, same date: only the change time (ctime) differs, and has to be read. */
static void changed_behind_the_date(void **state)
{
	(void)state;
	struct stat st;
	run_stage(CONFIG);
	usleep(80000);
	assert_true(holds(0));
	const char *path = scratch_path("photos/a.jpg");
	assert_int_equal(stat(path, &st), 0);
	int fd = open(path, O_WRONLY);
	assert_int_equal(write(fd, "PICTURE", 7), 7);
	struct timespec times[2] = { st.st_atim, st.st_mtim };
	assert_int_equal(futimens(fd, times), 0);
	close(fd);
	assert_false(holds("photos/a.jpg has changed"));
}

static void files_came_and_went(void **state)
{
	(void)state;
	run_stage(CONFIG);
	scratch_text("photos/b.jpg", "new");
	assert_false(holds("come or gone in photos"));
	unlink(scratch_path("photos/b.jpg"));
	assert_true(holds(0));
}

static void configuration_changed(void **state)
{
	(void)state;
	run_stage(CONFIG);
	scratch_text("capture.conf", "other.sigma = 9\neye.index = 1.4\n");  // what this stage does not read
	assert_true(holds(0));
	scratch_text("capture.conf", "stage.sigma = 2\n");  // the same value
	assert_true(holds(0));
	scratch_text("capture.conf", "stage.sigma = 3\n");
	assert_false(holds("stage.sigma has changed"));
	scratch_text("capture.conf", "quality = draft\n");
	assert_false(holds("has changed"));
	scratch_text("capture.conf", "photo.a.hint = 1 2 3\n");
	assert_false(holds("photo.a.hint is new"));
	scratch_text("capture.conf", "view.a.mm = 1\n");  // a pattern that another stage reads
	assert_true(holds(0));
}

static void note_dropped(void *ctx, const char *rel)
{
	char *all = ctx;
	strcat(strcat(all, rel), ";");
}

/* What a stage keeps to go on from is removed where its bytes are not those it left, once, and nothing else is. */
static void altered_files_are_dropped(void **state)
{
	(void)state;
	static const char *const kept[] = { "work/kept/a", "work/kept/b", "work/kept/gone", "work/keptnot/c" };
	struct err err = { 0 };
	char dropped[200] = "";
	for (int i = 0; i < COUNT(kept); i++)
		scratch_text(kept[i], "made");
	struct record *r = record_open(scratch_path("."), "stage", scratch_path("program"), CONFIG);
	for (int i = 0; i < COUNT(kept); i++)
		record_made(r, kept[i], 0, 0);
	assert_true(record_save(r, true, &err));
	record_free(r);
	scratch_text("work/kept/b", "mad");
	scratch_text("work/keptnot/c", "mad");
	unlink(scratch_path("%s", kept[2]));
	r = record_open(scratch_path("."), "stage", scratch_path("program"), CONFIG);
	assert_true(record_drop_altered(r, "work/kept", note_dropped, dropped, &err));
	record_free(r);
	assert_string_equal(dropped, "work/kept/b;");
	assert_true(file_exists(scratch_path("work/kept/a")) && !file_exists(scratch_path("work/kept/b")));
	assert_true(file_exists(scratch_path("work/keptnot/c")));
	// A run that goes on with them and is killed leaves other bytes, and no fault.
	scratch_text("work/kept/a", "longer");
	r = record_open(scratch_path("."), "stage", scratch_path("program"), CONFIG);
	assert_true(record_drop_altered(r, "work/kept", note_dropped, dropped, &err));
	record_free(r);
	assert_true(file_exists(scratch_path("work/kept/a")));
}

static void an_unfinished_run_does_not_hold(void **state)
{
	(void)state;
	struct err err = { 0 };
	struct record *r = record_open(scratch_path("."), "stage", scratch_path("program"), CONFIG);
	scratch_text(out, "made");
	record_made(r, out, 1, inputs);
	assert_true(record_save(r, false, &err));
	record_free(r);
	assert_false(holds("did not finish"));
	// What it had made before is not made again.
	r = record_open(scratch_path("."), "stage", scratch_path("program"), CONFIG);
	assert_true(record_fresh(r, out, 1, inputs));
	record_free(r);
}

static void a_damaged_record_is_none(void **state)
{
	(void)state;
	run_stage(CONFIG);
	scratch_text("work/.made/stage.json", "{\"complete\": true, \"outputs\": 3");
	assert_false(holds("never run"));
	scratch_text("work/.made/stage.json", "{\"complete\": true, \"outputs\": 3, \"config\": [], \"lists\": \"x\"}");
	assert_false(holds(0));
	scratch_text("work/.made/hashes", "[]");
	run_stage(CONFIG);
	assert_true(holds(0));
}

/* A capture from elsewhere brings a record from elsewhere: it counts as none, and nothing outside of the folder is removed because of it. */
static void a_record_of_a_strangers_making_is_refused(void **state)
{
	(void)state;
	static const char *const bad[] = {
		"{\"complete\": true, \"program\": \"%s\", \"config\": {\"stage.sigma\": 2}}",
		"{\"complete\": true, \"program\": \"%s\", \"lists\": {\"photos\": 7}}",
		"{\"complete\": true, \"program\": \"%s\", \"outputs\": {\"/dev/zero\": {\"hash\": \"0\"}}}",
		"{\"complete\": true, \"program\": \"%s\", \"outputs\": {\"work/x\": []}}",
	};
	char hash[33];
	struct err err = { 0 };
	assert_true(file_hash(hash, scratch_path("program"), 1 << 30, &err));
	for (int i = 0; i < COUNT(bad); i++) {
		char *text = mem_printf(bad[i], hash), *why = 0;
		struct conf conf = load_conf();
		scratch_text("work/.made/stage.json", text);
		assert_false(record_holds(scratch_path("."), "stage", scratch_path("program"), &conf, &why));
		assert_non_null(why);
		free(why);
		free(text);
		conf_free(&conf);
	}
}

static void count_dropped(void *ctx, const char *rel)
{
	(void)rel;
	++*(int *)ctx;
}

static void nothing_outside_the_folder_is_dropped(void **state)
{
	(void)state;
	struct err err = { 0 };
	int n = 0;
	scratch_text("precious", "mine");
	scratch_text("work/kept/altered", "new");
	scratch_text("work/.made/stage.json", "{\"outputs\": {\"work/kept/../../precious\": {\"hash\": \"0\"}, \"work/kept/altered\": {\"hash\": \"0\"}}}");
	struct record *r = record_open(scratch_path("."), "stage", scratch_path("program"), "");
	assert_true(record_drop_altered(r, "work/kept", count_dropped, &n, &err));
	assert_int_equal(n, 1);
	assert_true(file_exists(scratch_path("precious")) && !file_exists(scratch_path("work/kept/altered")));
	record_free(r);
}

/* What was looked for in vain is an input as well: it holds while that is not there. */
static void what_was_not_there_comes(void **state)
{
	(void)state;
	asked_watch(scratch_path("."));
	assert_false(file_exists(scratch_path("./optional")));
	char *data;
	size_t size;
	assert_false(file_read(&data, &size, scratch_path("./work/none.json"), 100, &(struct err){ 0 }));
	run_stage(CONFIG);
	assert_true(holds(0));
	scratch_text("work/none.json", "{}");
	assert_false(holds("input work/none.json is new"));
	run_stage(CONFIG);  // which is there now, and no longer asked for in vain
	assert_true(holds(0));
	scratch_text("optional", "x");
	assert_false(holds("input optional is new"));
}

/* A file that only has to be there: it may change, but not go. */
static void what_has_to_be_there_goes(void **state)
{
	(void)state;
	struct err err = { 0 };
	scratch_text("mark", "1");
	scratch_text("\xff", "1");
	struct record *r = record_open(scratch_path("."), "stage", scratch_path("program"), CONFIG);
	record_there(r, "mark");
	record_there(r, "\xff");
	assert_true(record_save(r, true, &err));
	record_free(r);
	assert_true(holds(0) && record_inputs_hold(scratch_path("."), "stage"));
	scratch_text("mark", "another");
	assert_true(holds(0));
	assert_int_equal(unlink(scratch_path("mark")), 0);
	assert_false(holds("input mark is missing") || record_inputs_hold(scratch_path("."), "stage"));
	scratch_text("mark", "1");
	assert_int_equal(unlink(scratch_path("\xff")), 0);
	assert_false(holds("input %%ff is missing"));
}

/* What a stage has read is all that counts there: not what it made, with which program or configuration, nor whether it came to its end. */
static void inputs_alone_hold(void **state)
{
	(void)state;
	struct err err = { 0 };
	char *capture = mem_str(scratch_path("."));
	run_stage(CONFIG);
	assert_true(record_inputs_hold(capture, "stage"));
	scratch_text("program", "another");
	scratch_text(out, "edited");
	assert_true(!holds(0) && record_inputs_hold(capture, "stage"));
	scratch_text("photos/a.jpg", "another");
	assert_false(record_inputs_hold(capture, "stage"));
	run_stage(CONFIG);
	assert_int_equal(unlink(scratch_path("photos/a.jpg")), 0);
	assert_false(record_inputs_hold(capture, "stage"));
	scratch_text("photos/a.jpg", "another");
	struct record *r = record_open(capture, "stage", scratch_path("program"), CONFIG);
	char hash[33];
	record_listing_hash(hash, 1, (char *[]){ "b.csv" });
	record_list(r, "script", hash);
	assert_true(record_save(r, true, &err) && !record_inputs_hold(capture, "stage"));
	scratch_text("script/b.csv", "");
	assert_true(record_inputs_hold(capture, "stage"));
	record_free(r);
	free(capture);
}

/* A run that makes a file of each of these inputs, "work/made/x" of "x". ends: whether it comes to its end. */
static void make_of(const char *config, int n, const char *const names[], bool ends)
{
	struct err err = { 0 };
	struct record *r = record_open(scratch_path("."), "stage", scratch_path("program"), config);
	for (int i = 0; i < n; i++) {
		char *rel = mem_printf("work/made/%s", names[i]);
		const char *in[] = { names[i] };
		if (!record_fresh(r, rel, 1, in)) {
			char *text = mem_printf("made %d", ++made);
			scratch_text(rel, text);
			record_made(r, rel, 1, in);
			assert_true(record_save(r, false, &err));
			free(text);
		}
		free(rel);
	}
	if (ends)
		assert_true(record_put_aside(r, "work", &err) && record_save(r, true, &err));
	record_free(r);
}

static bool is_there(const char *name)
{
	return file_exists(scratch_path("work/made/%s", name));
}

static bool is_aside(const char *name)
{
	return file_exists(scratch_path("work/.made/aside/made/%s", name));
}

/* What a run does not ask for any more is out of the way, and back, with its bytes, without being made, when it is asked for again. */
static void what_is_not_made_any_more_is_put_aside(void **state)
{
	(void)state;
	static const char *const both[] = { "a", "b" };
	made = 0;
	make_of(CONFIG, 2, both, true);
	assert_int_equal(made, 2);
	make_of(CONFIG, 1, both, true);
	assert_true(is_there("a") && !is_there("b") && is_aside("b"));
	make_of(CONFIG, 1, both, true);  // and stays there
	assert_true(is_aside("b"));
	make_of(CONFIG, 2, both, true);
	assert_int_equal(made, 2);
	assert_true(is_there("b") && !is_aside("b"));
	// Of another input it is made again.
	make_of(CONFIG, 1, both, true);
	scratch_text("b", "another");
	make_of(CONFIG, 2, both, true);
	assert_int_equal(made, 3);
	assert_true(is_there("b") && !is_aside("b"));
	// With another configuration it does not come back by itself, nor is it lost; what is made anew takes its place.
	make_of("stage.sigma = 3\n", 1, both, true);
	make_of("stage.sigma = 3\n", 1, both, true);
	assert_true(is_there("a") && !is_there("b") && is_aside("b"));
	made = 0;
	make_of("stage.sigma = 3\n", 2, both, true);
	assert_int_equal(made, 1);
	assert_true(is_there("b") && !is_aside("b"));
	assert_false(file_exists(scratch_path("work/.made/aside/made")));
}

/* A run that fails loses nothing; what it did not come to is still known to the next as something to put aside. */
static void a_run_that_fails_leaves_all_in_place(void **state)
{
	(void)state;
	static const char *const three[] = { "a", "b", "\xff\xfe" };  // the last name is no UTF-8
	made = 0;
	make_of(CONFIG, 3, three, true);
	scratch_text("a", "another");
	make_of(CONFIG, 1, three, false);
	assert_true(is_there("a") && is_there("b") && is_there(three[2]));
	make_of(CONFIG, 1, three, true);
	assert_true(is_there("a") && !is_there("b") && !is_there(three[2]) && is_aside("b") && is_aside(three[2]));
	make_of(CONFIG, 2, three, true);
	assert_int_equal(made, 4);
	assert_true(is_there("b"));
	// Nor is it made again by the next that asks for it.
	make_of(CONFIG, 1, three, false);
	make_of(CONFIG, 2, three, true);
	assert_int_equal(made, 4);
	// One that is ended when it has just put something aside leaves nothing there.
	make_of(CONFIG, 1, three, false);
	assert_true(aside_put(scratch_path("."), "work/made/b", &(struct err){ 0 }) && is_aside("b"));
	scratch_text("b", "another");
	make_of(CONFIG, 2, three, true);
	assert_true(is_there("b") && !is_aside("b"));
}

/* A stage that is not needed leaves no file, log or record; needed again, it has them all, and holds. */
static void a_stage_leaves_and_returns(void **state)
{
	(void)state;
	struct err err = { 0 };
	char *capture = mem_str(scratch_path("."));
	scratch_text("work/log/stage.json", "{}");
	scratch_text("work/made/mine", "not the stage's");
	run_stage(CONFIG);
	assert_true(record_return(capture, "stage", &err) && holds(0));
	assert_true(record_leave(capture, "stage", &err));
	assert_false(file_exists(scratch_path("%s", out)) || file_exists(scratch_path("work/log/stage.json")));
	assert_false(holds("never run"));
	assert_true(is_there("mine"));
	assert_true(record_leave(capture, "stage", &err));
	assert_true(record_return(capture, "stage", &err));
	assert_true(file_exists(scratch_path("%s", out)) && file_exists(scratch_path("work/log/stage.json")) && holds(0));
	// One that has run meanwhile has the newer files: those stay.
	assert_true(record_leave(capture, "stage", &err));
	scratch_text("photos/a.jpg", "another");
	run_stage(CONFIG);
	assert_true(record_return(capture, "stage", &err) && holds(0));
	free(capture);
}

/* A record of a stranger's making moves nothing that is not below work/, nor what stages lock and remember by. */
static void nothing_outside_is_put_aside(void **state)
{
	(void)state;
	struct err err = { 0 };
	scratch_text("precious", "mine");
	scratch_text("work/.made/lock", "");
	assert_int_equal(symlink(scratch_path("precious"), scratch_path("work/link")), 0);
	scratch_text("work/.made/stage.json", "{\"outputs\": {\"precious\": {}, \"work/../precious\": {}, \"/etc/passwd\": {}, \"work/.made/lock\": {}, \"work/link\": {}, "
	             "\"work/\": {}, \"%70\": 3, \"%%2f%\": [], \"work\": 0}, \"left\": [], \"aside\": {\"../x\": null}}");
	make_of(CONFIG, 0, 0, true);
	assert_true(file_exists(scratch_path("precious")) && file_exists(scratch_path("work/.made/lock")) && file_exists(scratch_path("work/link")));
	scratch_text("work/.made/stage.json", "{\"outputs\": {\"work/../precious\": {}, \"work/.made/lock\": {}, \"work/link\": {}}, \"left\": {\"precious\": null}}");
	assert_true(record_leave(scratch_path("."), "stage", &err));
	assert_true(file_exists(scratch_path("precious")) && file_exists(scratch_path("work/.made/lock")) && file_exists(scratch_path("work/link")));
}

/* What a stage makes while its disk fails does not count, whether it noticed or not. */
static void a_failing_disk_makes_nothing(void **state)
{
	(void)state;
	run_stage(CONFIG);
	assert_true(holds(0));
	asked_watch(scratch_path("."));
	asked_in_vain("/elsewhere/photos/a.jpg", EIO);
	assert_null(asked_trouble());
	asked_in_vain(scratch_path("./photos/a.jpg"), EIO);
	assert_non_null(asked_trouble());
	run_stage(CONFIG);
	assert_false(holds("its last run did not finish"));
	struct record *r = record_open(scratch_path("."), "stage", scratch_path("program"), CONFIG);
	assert_false(record_fresh(r, out, 1, inputs));
	assert_true(record_put_aside(r, "work", &(struct err){ 0 }) && file_exists(scratch_path("%s", out)));
	record_free(r);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(nothing_changed, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(bytes_changed, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(changed_behind_the_date, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(files_came_and_went, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(configuration_changed, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(an_unfinished_run_does_not_hold, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(altered_files_are_dropped, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(a_damaged_record_is_none, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(a_record_of_a_strangers_making_is_refused, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(nothing_outside_the_folder_is_dropped, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(what_was_not_there_comes, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(what_has_to_be_there_goes, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(inputs_alone_hold, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(what_is_not_made_any_more_is_put_aside, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(a_run_that_fails_leaves_all_in_place, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(a_stage_leaves_and_returns, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(nothing_outside_is_put_aside, setup, scratch_teardown),
		cmocka_unit_test_setup_teardown(a_failing_disk_makes_nothing, setup, scratch_teardown),  // the last: a disk stays broken
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
