#include "register/landmarks.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"

/* -1: the subject has no landmark of that name. */
static int subject_row(const struct opt_each_list *subject, const char *name)
{
	for (int i = 0; i < subject->n; i++)
		if (!strcmp(subject->items[i].name, name))
			return (int)subject->items[i].value[0];
	return -1;
}

/* One "name row" of the list. */
static bool take(int *moving, int *fixed, const char *text, const char *name, int target_vertices, int subject_vertices,
                 const struct opt_each_list *subject, struct err *err)
{
	char landmark[64];
	int row, end = 0;
	if (sscanf(text, " %63[a-z0-9_] %d %n", landmark, &row, &end) != 2 || text[end])
		return err_set(err, "capture.conf: target.%s.landmarks = ...%s...: must be a list of \"name row\", with commas between",
		               name, text);
	if (row < 0 || row >= target_vertices)
		return err_set(err, "capture.conf: target.%s.landmarks = %s: must be in [0, %d]", name, text, target_vertices - 1);
	*moving = row;
	*fixed = subject_row(subject, landmark);
	if (*fixed >= subject_vertices)
		return err_set(err, "capture.conf: subject.landmark.%s = %d: must be in [0, %d]", landmark, *fixed, subject_vertices - 1);
	return true;
}

bool landmarks_pair(struct nricp_landmarks *out, const char *name, const struct opt_each_list *lists, int target_vertices,
                    int subject_vertices, const struct opt_each_list *subject, struct err *err)
{
	enum { MAX = 256 };
	*out = (struct nricp_landmarks){ 0 };
	const char *text = 0;
	for (int i = 0; i < lists->n; i++)
		if (!strcmp(lists->items[i].name, name))
			text = lists->items[i].text;
	if (!text)
		return true;
	int *rows = mem_new(2 * MAX, sizeof *rows);
	char *copy = mem_str(text), *save = 0;
	bool ok = true;
	for (char *one = strtok_r(copy, ",", &save); one && ok; one = strtok_r(0, ",", &save)) {
		ok = out->n < MAX || err_set(err, "capture.conf: target.%s.landmarks: has more than %d, the most that are read", name, MAX);
		ok = ok && take(&rows[out->n], &rows[MAX + out->n], one, name, target_vertices, subject_vertices, subject, err);
		out->n += ok && rows[MAX + out->n] >= 0;
	}
	free(copy);
	out->moving = rows;
	out->fixed = rows + MAX;
	return ok;
}
