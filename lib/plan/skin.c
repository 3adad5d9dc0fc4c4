#include "plan/skin.h"

#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/call.h"
#include "base/file.h"
#include "base/mem.h"
#include "character/kind.h"

/* Files name their materials at their beginning. transfer reads all of them. */
enum { HEAD = 1 << 20 };

static bool brings_look(const char *path)
{
	struct stat st;
	const int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
	char *head = mem_new(HEAD + 1, 1);
	const ssize_t n = fd < 0 || fstat(fd, &st) || !S_ISREG(st.st_mode) ? 0 : read(fd, head, HEAD);
	if (fd >= 0)
		close(fd);
	const bool brings = n > 0 && character_names_look(path, head, (size_t)n);
	free(head);
	return brings;
}

/* render.skin or another key of where things come from, as render will read it: of capture.conf, else of its own configuration for that quality. */
struct source {
	char *value, *said;  // said: "render.skin = plain at quality = draft"
};

static bool source_of(struct source *s, const char *key, const char *config_dir, const struct conf *conf, struct err *err)
{
	const struct conf_item *own = conf_find(conf, key, 0), *q = conf_find(conf, "quality", 0);
	const bool given = own && own->layer && *own->value;
	const char *quality = q && *q->value ? q->value : "review";
	char *dir = config_dir ? mem_str(config_dir) : call_config_dir(), *path = mem_printf("%s/render.conf", dir);
	struct conf shipped = { 0 };
	const bool ok = given || conf_load(&shipped, path, "render.", 0, err);
	if (ok) {
		const struct conf_item *item = given ? own : conf_find(&shipped, key, quality);
		s->value = mem_str(item ? item->value : "auto");
		s->said = given ? mem_printf("%s = %s", key, s->value) : mem_printf("%s = %s at quality = %s", key, s->value, quality);
	}
	conf_free(&shipped);
	free(path);
	free(dir);
	return ok;
}

/* views: a mesh is made of views/. */
static struct plan_skin skin_of(const char *capture, const char *name, const struct source *source, bool views)
{
	char *path = mem_printf("%s/targets/%s", capture, name);
	struct plan_skin s = { .file = mem_printf("targets/%s", name) };
	if (brings_look(path)) {
		s.from = "own";
		s.why = mem_str("as the file has it");
	} else if (!strcmp(source->value, "plain")) {
		s.from = "one colour";
		s.why = mem_printf("the file brings no materials; %s", source->said);
	} else {
		const bool only = !strcmp(source->value, "video"), of_views = !strcmp(source->value, "views");
		s.from = of_views ? "views" : "video";
		s.why = mem_printf("the file brings no materials; where %s not show both eyes and a fifth of the face about them, %s%s", of_views ? "they do" : "the film does",
		                   only || of_views ? "render fails: render.skin = " : views ? "that of views/" : "one colour", only || of_views ? source->value : "");
	}
	free(path);
	return s;
}

static void iris_of(struct plan *plan, const struct source *source)
{
	const bool fitted = plan->rows[plan_stage_find("unrefract")].run, plain = !strcmp(source->value, "plain");
	plan->iris.from = fitted ? "photographs" : plain ? "drawn" : "video";
	if (fitted)
		plan->iris.why = mem_str("as fitted; where they are refused, as without any");
	else if (plain)
		plan->iris.why = mem_printf("there is no photograph of an eye; %s", source->said);
	else
		plan->iris.why = mem_printf("there is no photograph of an eye; where the film shows no iris of 24 px with white beside it, %s",
		                            strcmp(source->value, "video") ? "drawn" : "render fails: render.iris = video");
}

bool plan_skins(struct plan *plan, const char *config_dir, const struct conf *conf, struct err *err)
{
	struct file_list list;
	struct source source = { 0 }, iris = { 0 };
	if (!plan->rows[plan_stage_find("extrapolate")].run || !plan->rows[plan_stage_find("render")].run)
		return true;
	char *dir = mem_printf("%s/targets", plan->capture);
	const bool views = plan->rows[plan_stage_find("calibrate")].run && !plan_has_subject(plan->capture);
	bool ok = source_of(&source, "render.skin", config_dir, conf, err) && source_of(&iris, "render.iris", config_dir, conf, err) && file_list(&list, dir, err);
	for (int i = 0; ok && i < list.n; i++) {
		if (character_kind_of(list.names[i]) == CHARACTER_NONE)
			continue;
		plan->skins = mem_grow(plan->skins, (size_t)plan->n_skins + 1, sizeof *plan->skins);
		plan->skins[plan->n_skins++] = skin_of(plan->capture, list.names[i], &source, views);
	}
	if (ok) {
		file_list_free(&list);
		iris_of(plan, &iris);
	}
	free(source.value);
	free(source.said);
	free(iris.value);
	free(iris.said);
	free(dir);
	return ok;
}

void plan_skins_free(struct plan *plan)
{
	for (int i = 0; i < plan->n_skins; i++) {
		free(plan->skins[i].file);
		free(plan->skins[i].why);
	}
	free(plan->skins);
	free(plan->iris.why);
	plan->iris = (struct plan_iris){ 0 };
	plan->skins = 0;
	plan->n_skins = 0;
}
