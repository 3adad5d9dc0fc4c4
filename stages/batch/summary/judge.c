#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "base/template.h"
#include "summary.h"

struct judging {
	json_t *doubts;
	double score;
};

static void doubt(struct judging *j, char *sentence)
{
	json_array_append_new(j->doubts, template_text(sentence));
	free(sentence);
}

/* Counts how far a number is on its way to the doubtful. True beyond. */
static bool beyond(struct judging *j, double x, double most)
{
	if (!isfinite(x) || !(most > 0))
		return false;
	j->score = fmax(j->score, x / most);
	return x > most;
}

static void judge_limbus(struct judging *j, const json_t *record, const struct summary_conf *conf)
{
	const char *of = json_string_value(json_object_get(record, "of"));
	const double gross = record_number(record, "gross_probability"), theta = record_number(record, "theta_sigma_deg");
	if (!strcmp(record_text(record, "status"), "rejected")) {
		doubt(j, mem_printf("%s: rejected: %s", of, record_text(record, "reason")));
		j->score = fmax(j->score, 10);
		return;
	}
	if (!strcmp(record_text(record, "status"), "rough")) {
		j->score = fmax(j->score, 2);
		doubt(j, mem_printf("%s: known to %.2g %% only, and used for want of a better: %s", of, 100 * record_number(record, "known_to"), record_text(record, "reason")));
	} else if (beyond(j, gross, conf->gross) && !record_number(record, "by_hand"))
		doubt(j, mem_printf("%s: wrong with a chance of %.0f %%", of, 100 * gross));
	if (beyond(j, theta, conf->theta_deg))
		doubt(j, mem_printf("%s: tilt known to ± %.1f° alone", of, theta));
}

static void judge_registration(struct judging *j, const json_t *record)
{
	const char *of = json_string_value(json_object_get(record, "of"));
	if (!strcmp(record_text(record, "status"), "refused")) {
		doubt(j, mem_printf("%s: refused: %s", of, record_text(record, "reason")));
		j->score = fmax(j->score, 10);
	}
	for (int i = 0; i < 16; i++) {
		char *key = mem_printf("doubtful.%d", i);
		if (*record_text(record, key)) {
			doubt(j, mem_printf("%s: %s", of, record_text(record, key)));
			j->score = fmax(j->score, 2);
		}
		free(key);
	}
}

static void judge_record(struct judging *j, const json_t *record, const struct summary_conf *conf)
{
	const char *part = json_string_value(json_object_get(record, "part")), *of = json_string_value(json_object_get(record, "of"));
	const double difference = record_number(record, "difference_mean"), lost = record_number(record, "lost_frames");
	if (!strcmp(part, "limbus"))
		judge_limbus(j, record, conf);
	else if (!strcmp(part, "compare") && beyond(j, difference, conf->difference))
		doubt(j, mem_printf("%s: the rendering differs from it by %.1f (CIEDE2000)", of, difference));
	else if (!strcmp(part, "registration"))
		judge_registration(j, record);
	else if (!strcmp(part, "track") && lost > 0) {
		doubt(j, mem_printf("the head was lost in %.0f of %.0f frames", lost, record_number(record, "frames")));
		j->score = fmax(j->score, 1 + lost / fmax(record_number(record, "frames"), 1));
	}
}

/* The result's line: NAME, STATE, SECONDS, MIB, REASON, tabs between. */
static void take_result(json_t *capture, const char *result)
{
	char *text = mem_str(result), *field[5] = { "", "", "", "", "" }, *rest = text;
	text[strcspn(text, "\n")] = 0;
	for (int i = 0; i < 5 && rest; i++)
		field[i] = i < 4 ? strsep(&rest, "\t") : rest;
	json_object_set_new(capture, "state", json_string(!strcmp(field[1], "failed") ? "failed" : "pass"));
	if (*field[2])
		json_object_set_new(capture, "seconds", json_real(strtod(field[2], 0)));
	if (*field[3])
		json_object_set_new(capture, "peak_mib", json_real(strtod(field[3], 0)));
	if (*field[4])
		json_object_set_new(capture, "reason", template_text(field[4]));
	free(text);
}

void summary_judge(json_t *capture, const char *result, const struct summary_conf *conf)
{
	struct judging j = { .doubts = json_array() };
	const json_t *record;
	size_t i;
	if (result)
		take_result(capture, result);
	json_array_foreach(json_object_get(capture, "records"), i, record)
		judge_record(&j, record, conf);
	if (json_array_size(j.doubts) && !strcmp(json_string_value(json_object_get(capture, "state")), "pass"))
		json_object_set_new(capture, "state", json_string("doubt"));
	json_object_set_new(capture, "doubts", j.doubts);
	json_object_set_new(capture, "score", json_real(isfinite(j.score) ? round(j.score * 1e6) / 1e6 : 0));
}
