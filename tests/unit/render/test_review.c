/* review: the template engine, and the page of folders with little or hostile things in them. */
#include <fcntl.h>
#include <sys/wait.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/template.h"
#include "image/picture.h"
#include "tests/lib/scratch.h"
#include "tests/lib/unit.h"

static void fills(const char *template, const char *json, const char *expected)
{
	struct err err = { 0 };
	char *out;
	size_t size;
	json_t *data = json_loads(json, 0, 0);
	assert_non_null(data);
	assert_true(template_fill(&out, &size, template, data, &err));
	assert_string_equal(out, expected);
	assert_int_equal(size, strlen(expected));
	free(out);
	json_decref(data);
}

static void holes(void **state)
{
	(void)state;
	fills("a {{x}} b", "{\"x\": \"<i a='1' b=\\\"2\\\">&\"}", "a &lt;i a=&#39;1&#39; b=&quot;2&quot;&gt;&amp; b");
	fills("{{&x}}", "{\"x\": \"<i>\"}", "<i>");
	fills("[{{x}}]", "{}", "[]");
	fills("{{n}} {{r}}", "{\"n\": 7, \"r\": 0.25}", "7 0.25");
	fills("{{#l}}<{{.}}>{{/l}}{{^l}}none{{/l}}", "{\"l\": [\"a\", \"b&\"]}", "<a><b&amp;>");
	fills("{{#l}}x{{/l}}{{^l}}none{{/l}}", "{\"l\": []}", "none");
	fills("{{#o}}{{a}}{{b}}{{/o}}", "{\"o\": {\"a\": 1}, \"b\": 2}", "12");
	fills("{{#a}}{{#a}}{{.}}{{/a}}{{/a}}", "{\"a\": {\"a\": [\"in\"]}}", "in");
	fills("{{#t}}yes{{/t}}{{#f}}no{{/f}}{{#e}}no{{/e}}{{#z}}no{{/z}}", "{\"t\": true, \"f\": false, \"e\": \"\", \"z\": null}", "yes");
	fills("{{x}}", "{\"x\": \"a\\u0001\\u001bb\"}", "a  b");
	fills("{{ {{x", "{\"x\": 1}", "{{ {{x");
	fills("{{x}}", "{\"x\": \"{{y}}\", \"y\": \"never\"}", "{{y}}");  // a value is never a template
}

static void refuses(const char *template)
{
	struct err err = { 0 };
	char *out;
	size_t size;
	json_t *data = json_pack("{s:b,s:[i]}", "a", 1, "b", 1);
	assert_false(template_fill(&out, &size, template, data, &err));
	assert_null(out);
	assert_non_null(strstr(err.msg, "template"));
	json_decref(data);
}

static void mismatched(void **state)
{
	(void)state;
	refuses("{{#a}}x");
	refuses("x{{/a}}");
	refuses("{{#a}}{{#b}}{{/a}}{{/b}}");
	refuses("{{#a}}{{#a}}{{#a}}{{#a}}{{#a}}{{#a}}{{#a}}{{#a}}{{#a}}{{#a}}{{#a}}{{#a}}{{#a}}x{{/a}}{{/a}}{{/a}}{{/a}}{{/a}}"
	        "{{/a}}{{/a}}{{/a}}{{/a}}{{/a}}{{/a}}{{/a}}{{/a}}");
}

static void not_utf8(void **state)
{
	(void)state;
	json_t *text = template_text("caf\xe9 <");
	assert_string_equal(json_string_value(text), "caf\\xe9 <");
	json_decref(text);
	text = template_text("café");
	assert_string_equal(json_string_value(text), "café");
	json_decref(text);
}

/* Runs render on a folder. */
static int render(const char *program, const char *capture)
{
	pid_t pid = fork();
	if (pid == 0) {
		char *arg = mem_printf("--capture=%s", capture);
		int null = open("/dev/null", O_WRONLY);
		dup2(null, 2);
		execl(program, program, arg, "--quiet", (char *)0);
		_exit(127);
	}
	int status = 0;
	waitpid(pid, &status, 0);
	return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static const char *program(void)
{
	const char *bin = getenv("BIN");
	static char path[1024];
	snprintf(path, sizeof path, "%s/render", bin && *bin ? bin : "bin");
	return access(path, X_OK) == 0 ? path : 0;
}

static char *put(const char *dir, const char *name)
{
	return mem_printf("%s/%s", dir, name);
}

/* A photograph whose name is HTML, a fit with HTML in its reason, a log and pigments that are no JSON: the page is made,
 * says so, and nothing of it is live. */
static void hostile_folder(void **state)
{
	(void)state;
	struct err err = { 0 };
	const char *dir = scratch_path("capture"), *name = "photos/<img src=x onerror=alert(1)>&\"'.png";
	if (!program())
		skip();  // only where the programs have been built
	uint8_t px[32 * 24 * 3] = { 200 };
	char *photo = put(dir, name), *fit = put(dir, "work/limbus/<img src=x onerror=alert(1)>&\"'.json");
	char *log = put(dir, "work/log/limbus.json"), *pigment = put(dir, "work/iris/pigment.json");
	char *conf = put(dir, "capture.conf"), *page = put(dir, "work/review/index.html");
	static const char rejected[] = "{\"status\": \"rejected\", \"reason\": \"</script><script>alert(2)</script>\"}";
	static const char logged[] = "{\"stage\": \"limbus\", \"seconds\": 1.5, \"error\": \"<b>bad</b>\", \"figures\": "
	                             "{\"<u>x\": {\"value\": 2, \"unit\": \"<s>\"}}, \"skipped\": [\"<em>y</em>\"]}";
	char *folder = put(dir, "photos");
	assert_true(file_mkdirs(folder, &err));
	assert_true(picture_png_write(photo, px, 32, 24, 3, &err));
	assert_true(file_write(fit, rejected, strlen(rejected), &err) && file_write(log, logged, strlen(logged), &err)
	            && file_write(pigment, "{", 1, &err) && file_write(conf, "", 0, &err));
	assert_int_equal(render(program(), dir), 0);
	char *html;
	size_t size;
	assert_true(file_read(&html, &size, page, 1 << 24, &err));
	static const char *const never[] = { "<img src=x", "alert(1)>&\"", "<script>alert", "<b>bad", "<u>x", "<em>y", "<s>",
		                                 "http://", "https://", "src=\"//", "@import", "url(" };
	for (int i = 0; i < COUNT(never); i++)
		assert_null(strstr(html, never[i]));
	static const char *const shown[] = { "&lt;img src=x onerror=alert(1)&gt;&amp;&quot;&#39;", "&lt;/script&gt;", "&lt;b&gt;bad",
		                                 "&lt;em&gt;y", "No photograph has been unrefracted yet", "No pigments have been fitted",
		                                 "Not used:", "data:image/jpeg;base64," };
	for (int i = 0; i < COUNT(shown); i++)
		if (!strstr(html, shown[i]))
			fail_msg("the page does not say %s", shown[i]);
	char *const all[] = { photo, fit, log, pigment, conf, page, folder, html };
	for (int i = 0; i < COUNT(all); i++)
		free(all[i]);
}

/* A folder without photographs is not a fault of the page. */
static void empty_folder(void **state)
{
	(void)state;
	const char *dir = scratch_path("capture");
	struct err err = { 0 };
	if (!program())
		skip();
	assert_true(file_mkdirs(dir, &err));
	int status = render(program(), dir);
	char *page = put(dir, "work/review/index.html"), *html = 0;
	size_t size;
	assert_true(file_read(&html, &size, page, 1 << 24, &err));
	assert_non_null(strstr(html, "There are no photographs in this folder"));
	assert_true(status == 0 || status == 1);
	free(html);
	free(page);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(holes),          cmocka_unit_test(mismatched),   cmocka_unit_test(not_utf8),
		SCRATCH_TEST(hostile_folder), SCRATCH_TEST(empty_folder),
	};
	return cmocka_run_group_tests(tests, 0, 0);
}
