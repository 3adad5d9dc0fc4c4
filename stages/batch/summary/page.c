/* The page: a list of all captures as data, and a script that shows as many of them as are looked at. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/template.h"
#include "base/version.h"
#include "summary.h"

/* C23's #embed is newer than the compilers; .incbin is in both their assemblers. Paths are the repository's. */
#define EMBED(name, file) \
	__asm__(".section .rodata\n.global " #name "\n" #name ":\n.incbin \"" file "\"\n.byte 0\n.previous\n")
EMBED(summary_html, "stages/batch/summary/page.html");
EMBED(summary_css, "stages/batch/summary/page.css");
EMBED(summary_js, "stages/batch/summary/page.js");
extern const char summary_html[], summary_css[], summary_js[];

/* The record of that part, of a photograph the one that is likeliest to be wrong; null: there is none. */
static const json_t *worst_of(const json_t *capture, const char *part, const char *key)
{
	const json_t *record, *found = 0;
	double worst = -INFINITY;
	size_t i;
	json_array_foreach(json_object_get(capture, "records"), i, record) {
		const double x = record_number(record, key), at = isfinite(x) ? x : -1e300;
		if (!strcmp(json_string_value(json_object_get(record, "part")), part) && at > worst) {
			found = record;
			worst = at;
		}
	}
	return found;
}

static json_t *rounded(double x)
{
	char text[32];
	snprintf(text, sizeof text, "%.3g", x);
	return isfinite(x) ? json_real(strtod(text, 0)) : json_null();
}

/* The columns of the page that are numbers, in the order of its head (page.js). */
static json_t *numbers_of(const json_t *capture)
{
	static const struct {
		const char *part, *by, *key;
	} cells[] = {
		{ "limbus", "gross_probability", "gross_probability" },
		{ "limbus", "gross_probability", "theta_deg" },
		{ "limbus", "gross_probability", "theta_sigma_deg" },
		{ "compare", "difference_mean", "difference_mean" },
		{ "compare", "difference_mean", "explained_by_model" },
		{ "pigment", "residual", "abl.melanin.value" },
		{ "pigment", "residual", "abl.melanin.sigma" },
		{ "pigment", "residual", "stroma.melanin.value" },
		{ "pigment", "residual", "stroma.melanin.sigma" },
		{ "train", "lids_left.held_out_px", "lids_left.held_out_px" },
		{ "compare", "difference_mean", "model_difference_mean" },
	};
	json_t *out = json_array();
	for (int i = 0; i < COUNT(cells); i++) {
		const json_t *record = worst_of(capture, cells[i].part, cells[i].by);
		json_array_append_new(out, record ? rounded(record_number(record, cells[i].key)) : json_null());
	}
	return out;
}

/* [state, name, folder, hash, thumb, review, seconds, reasons [], numbers []] */
static json_t *item_of(const json_t *capture)
{
	const char *reason = json_string_value(json_object_get(capture, "reason"));
	json_t *reasons = json_deep_copy(json_object_get(capture, "doubts"));
	if (reason && *reason)
		json_array_insert_new(reasons, 0, json_string(reason));
	return json_pack("[O,O,O,O,O,O,O,o,o]", json_object_get(capture, "state"), json_object_get(capture, "capture"), json_object_get(capture, "folder"),
	                 json_object_get(capture, "hash"), json_object_get(capture, "thumb"), json_object_get(capture, "review"),
	                 json_object_get(capture, "seconds"), reasons, numbers_of(capture));
}

/* JSON that holds no "<": nothing in it ends the element it stands in. free(). */
static char *inert(const json_t *json)
{
	char *text = json_dumps(json, JSON_COMPACT | JSON_REAL_PRECISION(6)), *out = 0;
	size_t size;
	FILE *f = open_memstream(&out, &size);
	for (const char *s = text; *s; s++)
		if (*s == '<')
			fputs("\\u003c", f);
		else
			fputc(*s, f);
	fclose(f);
	free(text);
	return out;
}

bool summary_page(const json_t *captures, const char *title, const char *path, struct err *err)
{
	json_t *items = json_array(), *capture;
	size_t i, size;
	json_array_foreach(captures, i, capture)
		json_array_append_new(items, item_of(capture));
	char *data = inert(items), *text = 0;
	json_t *fill = json_pack("{s:o,s:s,s:s,s:s,s:s}", "title", template_text(title), "version", EYEWRIGHT_VERSION, "css", summary_css, "js", summary_js,
	                         "data", data);
	bool ok = template_fill(&text, &size, summary_html, fill, err) && file_write(path, text, size, err);
	json_decref(fill);
	json_decref(items);
	free(data);
	free(text);
	return ok;
}
