#include "base/front_use.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"

#define FRONT_FILE "work/.made/front"

enum { FILE_LIMIT = 1 << 16 };

bool front_save(const struct front *front, const struct front_ask *ask, int n, const int chosen[], const char *capture,
                bool *changed, struct err *err)
{
	char *text = 0, *was = 0, *path = mem_printf("%s/" FRONT_FILE, capture);
	size_t size = 0;
	struct err none = { 0 };
	FILE *f = open_memstream(&text, &size);
	fprintf(f, "; %s\n", ask->text);
	for (int s = 0; s < n; s++)
		if (chosen[s] >= 0)
			fprintf(f, "%s = %s\n", front->points[chosen[s]].stage, front->points[chosen[s]].name);
	fclose(f);
	size_t was_size;
	*changed = !file_read(&was, &was_size, path, FILE_LIMIT, &none) || strcmp(was, text);
	bool ok = !*changed || file_write(path, text, size, err);
	free(was);
	free(text);
	free(path);
	return ok;
}

/* The name of the point chosen for this stage, "" where none is; null when the choice was made for another request. free(). */
static char *chosen_name(const char *path, const struct front_ask *ask, const char *stage)
{
	char *text = 0, *name = 0;
	size_t size, n = strlen(ask->text), m = strlen(stage);
	struct err none = { 0 };
	if (file_read(&text, &size, path, FILE_LIMIT, &none) && !strncmp(text, "; ", 2) && !strncmp(text + 2, ask->text, n) && text[2 + n] == '\n') {
		name = mem_str("");
		for (const char *line = text; line && *line; line = strchr(line, '\n'), line += !!line)
			if (!strncmp(line, stage, m) && !strncmp(line + m, " = ", 3)) {
				free(name);
				name = mem_printf("%.*s", (int)strcspn(line + m + 3, "\n"), line + m + 3);
			}
	}
	free(text);
	return name;
}

/* Adds the point's settings ("scale = 0.5, max_size = 512") as defaults of the preset in effect, so that capture.conf and the
 * command line have precedence. */
static void add_settings(struct conf *conf, const struct front_point *p, const char *path)
{
	conf->files = mem_grow(conf->files, (size_t)conf->n_files + 1, sizeof *conf->files);
	const char *file = conf->files[conf->n_files++] = mem_str(path), *quality = conf_find(conf, "quality", 0)->value;
	for (const char *at = p->settings; *at;) {
		size_t n = strcspn(at, ","), key = strcspn(at, " =");
		const char *value = memchr(at, '=', n);
		if (value) {
			value += 1 + strspn(value + 1, " ");
			conf->items = mem_grow(conf->items, (size_t)conf->n + 1, sizeof *conf->items);
			conf->items[conf->n++] = (struct conf_item){ mem_printf("%s.%.*s.%s", p->stage, (int)key, at, quality),
				mem_printf("%.*s", (int)(at + n - value), value), file, p->line, 0 };
		}
		at += n + (at[n] == ',');
		at += strspn(at, " ");
	}
}

bool front_apply(struct conf *conf, const char *stage, const char *capture, const char *config_dir, struct err *err)
{
	struct front_ask ask;
	if (!front_ask(&ask, conf, err))
		return false;
	if ((!ask.error && !ask.time) || !strcmp(stage, "plan"))
		return true;
	char *made = mem_printf("%s/" FRONT_FILE, capture), *path = mem_printf("%s/fronts.conf", config_dir);
	char *name = chosen_name(made, &ask, stage);
	struct front front = { 0 };
	bool ok = name ? front_load(&front, path, err)
	               : err_set(err, "%s: no setting is chosen yet: run plan first (make CAPTURE=DIR plan)", ask.text);
	bool found = !name || !*name;
	for (int i = 0; ok && i < front.n && !found; i++)
		if (!strcmp(front.points[i].stage, stage) && !strcmp(front.points[i].name, name)) {
			add_settings(conf, &front.points[i], path);
			found = true;
		}
	if (ok && !found)
		ok = err_set(err, "%s: %s.%s: no such point in %s: run plan again", made, stage, name, path);
	front_free(&front);
	free(made);
	free(path);
	free(name);
	return ok;
}
