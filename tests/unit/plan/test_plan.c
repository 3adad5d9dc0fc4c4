/* The table of stages against the programs and configuration files that there are; what a folder's names decide. */
#include "tests/lib/unit.h"

#include <glob.h>
#include <unistd.h>

#include "base/conf.h"
#include "base/file.h"
#include "base/mem.h"
#include "plan/decide.h"
#include "plan/meshes.h"
#include "plan/setting.h"
#include "plan/skin.h"
#include "tests/lib/scratch.h"

static int teardown(void **state)
{
	(void)state;
	scratch_close();
	return 0;
}

static int setup(void **state)
{
	(void)state;
	scratch_open();
	return 0;
}

/* The folder that holds the source of that stage. */
static const char *source_of(const char *name)
{
	static char path[100];
	snprintf(path, sizeof path, strcmp(name, "render") ? "stages/%s/main.c" : "%s/main.c", name);
	return path;
}

static void every_program_is_in_the_table(void **state)
{
	(void)state;
	glob_t found;
	assert_int_equal(glob("stages/*/main.c", 0, 0, &found), 0);
	assert_int_equal(found.gl_pathc, PLAN_STAGES - 1);  // render's stands in a folder of its own
	for (size_t i = 0; i < found.gl_pathc; i++) {
		char name[100];
		assert_int_equal(sscanf(found.gl_pathv[i], "stages/%99[^/]", name), 1);
		if (plan_stage_find(name) < 0)
			fail_msg("%s: not in lib/plan/stages.c", found.gl_pathv[i]);
	}
	globfree(&found);
	for (int i = 0; i < PLAN_STAGES; i++)
		if (!file_exists(source_of(plan_stages[i].name)))
			fail_msg("%s: no such program: %s", plan_stages[i].name, source_of(plan_stages[i].name));
	assert_int_equal(plan_stage_find("render"), PLAN_STAGES - 1);
	assert_int_equal(plan_stage_find("rende"), -1);
}

static void every_stage_has_its_configuration_and_its_cost(void **state)
{
	(void)state;
	struct conf conf = { 0 };
	struct err err = { 0 };
	assert_true(conf_load(&conf, "config/plan.conf", "", 0, &err));
	for (int i = 0; i < PLAN_STAGES; i++) {
		char *path = mem_printf("config/%s.conf", plan_stages[i].name), *key = mem_printf("%s_seconds", plan_stages[i].name),
		     *mib = mem_printf("%s_mib", plan_stages[i].name);
		if (!file_exists(path))
			fail_msg("%s is missing", path);
		if (!conf_find(&conf, key, 0))
			fail_msg("config/plan.conf: no row %s", key);
		if (!conf_find(&conf, mib, 0))
			fail_msg("config/plan.conf: no row %s", mib);
		free(mib);
		free(path);
		free(key);
	}
	for (int i = 0; i < conf.n; i++) {
		char name[100];
		if (sscanf(conf.items[i].key, "%99[a-z]_", name) == 1 && plan_stage_find(name) < 0)
			fail_msg("config/plan.conf: %s: no such stage", conf.items[i].key);
	}
	conf_free(&conf);
}

static void what_a_stage_needs_runs_before_it(void **state)
{
	(void)state;
	for (int i = 0; i < PLAN_STAGES; i++) {
		const struct plan_stage *s = &plan_stages[i];
		assert_non_null(s->does);
		assert_non_null(s->without);
		if (s->needs)
			assert_in_range(plan_stage_find(s->needs), 1, i - 1);
		for (int k = 0; k < 2 && s->other[k].needs; k++)
			assert_in_range(plan_stage_find(s->other[k].needs), 1, i - 1);
		for (int j = 0; j < PLAN_STAGES; j++)
			assert_false(j >= i && plan_stage_needs(i, j));
	}
}

/* Why each stage does or does not run in a folder with these files; no program stands beside the test's. */
static struct plan decided(const char *const files[], const char *capture_conf)
{
	struct plan plan;
	struct conf conf = { 0 };
	struct err err = { 0 };
	const struct plan_cost cost[PLAN_STAGES] = { 0 };
	for (int i = 0; files[i]; i++)
		scratch_text(files[i], "x");
	assert_true(conf_load(&conf, scratch_text("capture.conf", capture_conf), "", 1, &err));
	if (!plan_decide(&plan, scratch_path("."), cost, &conf, &err))
		fail_msg("%s", err.msg);
	conf_free(&conf);
	return plan;
}

static const char *why(const struct plan *plan, const char *name)
{
	return plan->rows[plan_stage_find(name)].reason;
}

static void names_decide(void **state)
{
	(void)state;
	const char *const unbuilt = "its program is not built";
	struct plan p = decided((const char *[]){ "photos/a.jpg", 0 }, "");
	assert_string_equal(why(&p, "limbus"), unbuilt);
	assert_string_equal(why(&p, "render"), unbuilt);
	assert_string_equal(why(&p, "track"), plan_stages[plan_stage_find("track")].without);
	assert_string_equal(why(&p, "calibrate"), plan_stages[plan_stage_find("calibrate")].without);
	assert_int_equal(p.n_run, 0);
	assert_int_equal(p.n_photos, 1);
	p = decided((const char *[]){ "video/a.mp4", "targets/a.txt", 0 }, "");
	assert_string_equal(why(&p, "calibrate"), unbuilt);
	assert_string_equal(why(&p, "transfer"), plan_stages[plan_stage_find("transfer")].without);  // that is no mesh
	p = decided((const char *[]){ "targets/a.ply", 0 }, "camera.focal_px = 1000\n");
	assert_string_equal(why(&p, "transfer"), unbuilt);
	assert_string_equal(why(&p, "calibrate"), plan_stages[plan_stage_find("calibrate")].without);  // the lens is given
	assert_true(p.rows[plan_stage_find("calibrate")].told && !p.rows[plan_stage_find("animate")].told);
	p = decided((const char *[]){ "views/a.jpg", "views/b.jpg", 0 }, "camera.focal_px = 1000\n");
	assert_string_equal(why(&p, "calibrate"), unbuilt);
}

static void an_empty_folder_is_refused(void **state)
{
	(void)state;
	struct plan plan;
	struct conf conf = { 0 };
	struct err err = { 0 };
	const struct plan_cost cost[PLAN_STAGES] = { 0 };
	assert_false(plan_decide(&plan, scratch_path("."), cost, &conf, &err));
	assert_false(plan_decide(&plan, scratch_path("none"), cost, &conf, &(struct err){ 0 }));
}

#define SUBJECT "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n"

static void characters_of_the_subjects_topology_are_counted(void **state)
{
	(void)state;
	int all, same;
	scratch_text("subject.obj", SUBJECT);
	scratch_text("targets/a.obj", "v 0 0 5\nv 2 0 0\nv 0 2 0\nv 2 2 1\nf 1 2 3\nf 2 4 3\n");
	scratch_text("targets/b.obj", "v 0 0 5\nv 2 0 0\nv 0 2 0\nv 2 2 1\nf 1 2 4\nf 1 4 3\n");
	scratch_text("targets/c.obj", "v 0 0 5\nv 2 0 0\nv 0 2 0\nf 1 2 3\n");
	scratch_text("targets/d.txt", SUBJECT);
	plan_characters(&all, &same, scratch_path("."));
	assert_int_equal(all, 3);
	assert_int_equal(same, 1);
}

/* What a folder holds is what it costs: photographs, frames, characters, their clips, a script. */
static void what_a_folder_holds_is_paid_for(void **state)
{
	(void)state;
	char *film;
	size_t size;
	struct err err = { 0 };
	struct plan_cost cost = { .seconds = { 1, 10, 100, 1000, 1e4, 1e5 } };
	assert_true(file_read(&film, &size, "samples/face/video/face.mp4", 10000000, &err));
	scratch_write("video/face.mp4", film, size);
	free(film);
	struct plan plan = decided((const char *[]){ "targets/a.obj", "targets/b.ply", "targets/c.txt", 0 }, "camera.focal_px = 1000\n");
	NEAR(plan_cost_seconds(&cost, &plan), 1 + 1000 * 0.3 + 1e4 * 2 + 1e5 * 2 * 0.3, 1e-6);
	plan = decided((const char *[]){ "script/a.csv", 0 }, "camera.focal_px = 1000\n");
	NEAR(plan_cost_seconds(&cost, &plan), 1 + 1000 * 0.3 + 1e4 * 2 + 1e5 * 2 * 0.6, 1e-6);
	plan.mpx = 2;
	plan.mtexel = 3;
	NEAR(plan_cost_seconds(&cost, &plan), 1 + 20 + 300 + 1000 * 0.3 + 1e4 * 2 + 1e5 * 2 * 0.6, 1e-6);
}

#define FRONTS \
	"limbus.fast = 0.4 mm, 0.1 s + 0.1 s/Mpx: a = 4\n" \
	"limbus.fine = 0.1 mm, 0.2 s + 0.2 s/Mpx: a = 2\n" \
	"unrefract.coarse = 0.05 mm, 0.1 s + 0 s/Mpx: scale = 0.25, max_size = 512\n" \
	"unrefract.middle = 0.02 mm, 0.2 s + 0 s/Mpx: scale = 0.5, max_size = 512\n" \
	"unrefract.fine = 0.01 mm, 0.3 s + 0 s/Mpx: scale = 1, max_size = 4096\n"

/* A plan of that many megapixels in which these stages run, and what its capture.conf asks for. */
static void ask(struct plan *plan, struct plan_choice *choice, const struct plan_cost cost[PLAN_STAGES], int n, const char *const stages[], const char *text)
{
	struct conf conf = { 0 };
	struct err err = { 0 };
	*plan = (struct plan){ .capture = scratch_path("."), .mpx = 2, .largest_mpx = 1.92 };
	for (int i = 0; i < PLAN_STAGES; i++)
		plan->rows[i].name = plan_stages[i].name;
	for (int i = 0; i < n; i++)
		plan->rows[plan_stage_find(stages[i])].run = true;
	scratch_text("config/fronts.conf", FRONTS);
	scratch_text("config/unrefract.conf", "scale = 1\nscale.draft = 0.5\nmax_size = 1536\nmax_size.draft = 400\n");
	assert_true(conf_load(&conf, scratch_text("capture.conf", text), "", 1, &err));
	if (!plan_setting(choice, plan, cost, scratch_path("config"), &conf, &err))
		fail_msg("%s", err.msg);
	conf_free(&conf);
}

static void forget(struct plan *plan, struct plan_choice *choice)
{
	for (int i = 0; i < PLAN_STAGES; i++)
		free(plan->rows[i].setting);
	plan_choice_free(choice);
}

static double seconds_of(const struct plan *plan)
{
	double sum = 0;
	for (int i = 1; i < PLAN_STAGES; i++)
		sum += plan->rows[i].run ? plan->rows[i].seconds : 0;
	return sum;
}

static void a_setting_is_chosen_for_stages_that_run(void **state)
{
	(void)state;
	static const struct plan_cost cost[PLAN_STAGES] = { 0 };
	struct plan plan;
	struct plan_choice choice;
	const int limbus = plan_stage_find("limbus");
	ask(&plan, &choice, cost, 1, (const char *const[]){ "limbus" }, "error = 0.2 mm\n");
	assert_string_equal(choice.front.points[choice.chosen[limbus]].name, "fine");
	assert_non_null(strstr(choice.line, "limbus fine"));
	assert_non_null(strstr(plan.rows[limbus].setting, "a = 2"));
	NEAR(plan.rows[limbus].seconds, 0.2 + 2 * 0.2, 1e-12);
	forget(&plan, &choice);
}

/* The iris map's texels are those of the preset, of capture.conf, of the point that is chosen: 0.58 of 1600 px at scale 1. */
static void a_finer_map_costs_more(void **state)
{
	(void)state;
	static const char *const stages[] = { "limbus", "unrefract", "relief" };
	struct plan_cost cost[PLAN_STAGES] = { 0 };
	cost[plan_stage_find("relief")] = (struct plan_cost){ .seconds = { 0.1, 0, 2 } };
	static const struct { const char *conf; double side; } cases[] = {
		{ "", 928 }, { "quality = draft\n", 400 }, { "unrefract.scale = 0.25\n", 232 }, { "error = 0.02 mm\n", 464 }, { "error = 0.001 mm\n", 928 },
		{ "error = 0.02 mm\nunrefract.max_size = 100\n", 100 },
	};
	for (int i = 0; i < COUNT(cases); i++) {
		struct plan plan;
		struct plan_choice choice;
		ask(&plan, &choice, cost, COUNT(stages), stages, cases[i].conf);
		const double mtexel = cases[i].side * cases[i].side * 1e-6;
		NEAR(plan.mtexel, mtexel, 2e-4 * mtexel);
		NEAR(plan.rows[plan_stage_find("relief")].seconds, 0.1 + 2 * plan.mtexel, 1e-12);
		forget(&plan, &choice);
	}
}

/* For every time: the choice keeps to it wherever one of all the combinations does, and then none is more exact; else none is quicker. */
static void a_time_is_kept_where_it_can_be(void **state)
{
	(void)state;
	static const char *const stages[] = { "limbus", "unrefract", "relief" };
	struct plan_cost cost[PLAN_STAGES] = { 0 };
	cost[plan_stage_find("relief")] = (struct plan_cost){ .seconds = { 0.1, 0, 2 } };
	static const double limbus_s[] = { 0.3, 0.6 }, limbus_error[] = { 0.4, 0.1 };
	static const double side[] = { 232, 464, 928 }, unrefract_s[] = { 0.1, 0.2, 0.3 }, unrefract_error[] = { 0.05, 0.02, 0.01 };
	for (int ms = 100; ms < 3500; ms += 50) {
		char text[40];
		struct plan plan;
		struct plan_choice choice;
		snprintf(text, sizeof text, "time = %d ms\n", ms);
		ask(&plan, &choice, cost, COUNT(stages), stages, text);
		double least = INFINITY, best = INFINITY;
		for (int l = 0; l < 2; l++)
			for (int u = 0; u < 3; u++) {
				const double s = limbus_s[l] + unrefract_s[u] + 0.1 + 2e-6 * side[u] * side[u], worth = log(limbus_error[l] * unrefract_error[u]);
				least = fmin(least, s);
				if (s <= ms / 1000.0)
					best = fmin(best, worth);
			}
		const double s = seconds_of(&plan);
		double got = 0;
		for (int i = 0; i < PLAN_STAGES; i++)
			got += choice.chosen[i] < 0 ? 0 : log(choice.front.points[choice.chosen[i]].error);
		if (isfinite(best)) {
			assert_true(s <= ms / 1000.0 + 1e-3);
			NEAR(got, best, 1e-9);
		} else {
			NEAR(s, least, 1e-3);
		}
		assert_int_equal(!isfinite(best), !!strstr(choice.line, "the least there is"));
		forget(&plan, &choice);
	}
}

/* What plan says of a character's skin and irises. The expected texts' beginnings are the manual's (README.md, config/render.conf). */
static void a_characters_skin_is_told_beforehand(void **state)
{
	(void)state;
	static const struct { const char *file, *text, *conf, *from, *why; } cases[] = {
		{ "a.obj", "v 0 0 0\n", "", "video", "no materials" },
		{ "a.obj", "v 0 0 0\n", "quality = draft\n", "one colour", "render.skin = plain at quality = draft" },
		{ "a.obj", "v 0 0 0\n", "quality = draft\nrender.skin = auto\n", "video", "about them, one colour" },
		{ "a.obj", "v 0 0 0\n", "render.skin = plain\n", "one colour", "render.skin = plain" },
		{ "a.obj", "v 0 0 0\n", "render.skin = video\n", "video", "render fails: render.skin = video" },
		{ "a.obj", "v 0 0 0\n", "render.skin = views\n", "views", "render fails: render.skin = views" },
		{ "a.obj", "v 0 0 0\n", "", "video", "about them, that of views/" },
		{ "a.obj", "# a head\nmtllib head.mtl\n", "render.skin = video\n", "own", "as the file has it" },
		{ "a.obj", "# no mtllib here\n", "", "video", "no materials" },
		{ "a.ply", "ply\ncomment TextureFile a.png\nend_header\n", "", "own", "as the file has it" },
		{ "a.ply", "ply\nend_header\ncomment TextureFile a.png\n", "", "video", "no materials" },
		{ "a.glb", "glTF", "quality = draft\n", "own", "as the file has it" },
	};
	static const struct { const char *conf, *from, *why; bool photos; } irises[] = {
		{ "", "video", "no photograph of an eye; where the film shows no iris of 24 px with white beside it, drawn", false },
		{ "render.iris = video\n", "video", "render fails: render.iris = video", false },
		{ "render.iris = plain\n", "drawn", "render.iris = plain", false },
		{ "render.iris = video\n", "photographs", "as fitted", true },
	};
	scratch_text("config/render.conf", "skin = auto\nskin.draft = plain\niris = auto\n");
	scratch_text("targets/a.obj", "v 0 0 0\n");
	for (int i = 0; i < COUNT(irises); i++) {
		struct plan plan = { .capture = scratch_path(".") };
		struct conf conf = { 0 };
		struct err err = { 0 };
		plan.rows[plan_stage_find("extrapolate")].run = plan.rows[plan_stage_find("render")].run = true;
		plan.rows[plan_stage_find("unrefract")].run = irises[i].photos;
		assert_true(conf_load(&conf, scratch_text("capture.conf", irises[i].conf), "", 1, &err));
		assert_true(plan_skins(&plan, scratch_path("config"), &conf, &err));
		assert_string_equal(plan.iris.from, irises[i].from);
		if (!strstr(plan.iris.why, irises[i].why))
			fail_msg("%s: %s", irises[i].conf, plan.iris.why);
		plan_skins_free(&plan);
		conf_free(&conf);
	}
	for (int i = 0; i < COUNT(cases); i++) {
		struct plan plan = { .capture = scratch_path(".") };
		struct conf conf = { 0 };
		struct err err = { 0 };
		char *file = mem_printf("targets/%s", cases[i].file);
		scratch_text(file, cases[i].text);
		scratch_text("targets/a.mtl", "no character");
		assert_true(conf_load(&conf, scratch_text("capture.conf", cases[i].conf), "", 1, &err));
		assert_true(plan_skins(&plan, scratch_path("config"), &conf, &err));
		assert_int_equal(plan.n_skins, 0);  // no rig is made
		plan.rows[plan_stage_find("extrapolate")].run = plan.rows[plan_stage_find("render")].run = true;
		plan.rows[plan_stage_find("calibrate")].run = strstr(cases[i].why, "views");
		assert_true(plan_skins(&plan, scratch_path("config"), &conf, &err));
		assert_int_equal(plan.n_skins, 1);
		assert_string_equal(plan.skins[0].file, file);
		assert_string_equal(plan.skins[0].from, cases[i].from);
		if (!strstr(plan.skins[0].why, cases[i].why))
			fail_msg("%s with %s: %s", cases[i].file, cases[i].conf, plan.skins[0].why);
		plan_skins_free(&plan);
		unlink(scratch_path("%s", file));
		conf_free(&conf);
		free(file);
	}
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(every_program_is_in_the_table),
		cmocka_unit_test(every_stage_has_its_configuration_and_its_cost),
		cmocka_unit_test(what_a_stage_needs_runs_before_it),
		cmocka_unit_test_setup_teardown(names_decide, setup, teardown),
		cmocka_unit_test_setup_teardown(an_empty_folder_is_refused, setup, teardown),
		cmocka_unit_test_setup_teardown(characters_of_the_subjects_topology_are_counted, setup, teardown),
		cmocka_unit_test_setup_teardown(what_a_folder_holds_is_paid_for, setup, teardown),
		cmocka_unit_test_setup_teardown(a_setting_is_chosen_for_stages_that_run, setup, teardown),
		cmocka_unit_test_setup_teardown(a_finer_map_costs_more, setup, teardown),
		cmocka_unit_test_setup_teardown(a_time_is_kept_where_it_can_be, setup, teardown),
		cmocka_unit_test_setup_teardown(a_characters_skin_is_told_beforehand, setup, teardown),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
