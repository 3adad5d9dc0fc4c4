/* compare: two folders of `make bench`, row by row: what became slower or less exact beyond the spread, what better, what
 * is in one alone. Exit 1 when anything became worse.
 *
 *     compare BEFORE AFTER
 *
 * Time: worse when the quartiles no longer overlap and the median grew by more than a tenth (of a single
 * measurement, which has no spread, three tenths). The machine's speed is divided out first: each benchmark measures a
 * yardstick with its rows (NAME.yard). Error: worse by more than a fiftieth (the same cases
 * give the same errors; another compiler's rounding does not reach that).
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"
#include "math/stats.h"
#include "tests/lib/bench/csv.h"

enum column { TABLE, METHOD, SETTING, PER, MEDIAN, LOW, HIGH, ERROR, UNIT, ERROR_OF };
static const double least_time = 1.1, least_once = 1.3, least_error = 1.02;

struct pair {
	const struct csv_row *before, *after;
	const char *name;
	double slower;  // the machine, after to before
};

struct result {
	int n, worse, better, gone, added;
	struct pair *pairs;
};

static bool same_row(const struct csv_row *a, const struct csv_row *b)
{
	static const enum column keys[] = { TABLE, METHOD, SETTING, PER, UNIT, ERROR_OF };
	for (int i = 0; i < COUNT(keys); i++)
		if (strcmp(a->cell[keys[i]], b->cell[keys[i]]) != 0)
			return false;
	return true;
}

static const struct csv_row *find(const struct csv *in, const struct csv_row *row)
{
	for (int i = 0; i < in->n; i++)
		if (same_row(&in->rows[i], row))
			return &in->rows[i];
	return 0;
}

static double number(const struct csv_row *row, enum column c)
{
	return csv_number(row->cell[c]);
}

static void tell(const char *what, const struct pair *p, double before, double after, const char *unit, const char *of)
{
	char *const *c = p->after->cell;
	printf("%-7s %s: %s, %s, %s: %s %.4g -> %.4g %s\n", what, p->name, c[TABLE], c[METHOD], c[SETTING], of, before, after, unit);
}

/* Seconds of the yardstick beside a table; NAN without one. */
static double yard_of(const char *dir, const char *name, int stem)
{
	char *path = mem_printf("%s/%.*s.yard", dir, stem, name), *text = 0;
	size_t size;
	struct err none = { 0 };
	double s = file_read(&text, &size, path, 64, &none) ? csv_number(text) : NAN;
	free(text);
	free(path);
	return s > 0 && isfinite(s) ? s : NAN;
}

/* How much slower the machine was; without a yardstick in both the times stand as they are. */
static double machine(const char *const dir[2], const char *name, int stem)
{
	double slower = yard_of(dir[1], name, stem) / yard_of(dir[0], name, stem);
	if (!isnan(slower))
		return slower;
	printf("note    %s: no yardstick in both: times as they stand\n", name);
	return 1;
}

static void judge(struct result *r, const struct pair *p)
{
	double was = number(p->before, MEDIAN) * p->slower, is = number(p->after, MEDIAN);
	double was_low = number(p->before, LOW) * p->slower, was_high = number(p->before, HIGH) * p->slower;
	const char *unit = p->after->cell[UNIT], *of = p->after->cell[ERROR_OF];
	bool once = number(p->before, LOW) == number(p->before, HIGH) || number(p->after, LOW) == number(p->after, HIGH);
	double least = once ? least_once : least_time;
	if (is > least * was && number(p->after, LOW) > was_high) {
		tell("SLOWER", p, was, is, "s", "time");
		r->worse++;
	} else if (is * least < was && number(p->after, HIGH) < was_low) {
		tell("faster", p, was, is, "s", "time");
		r->better++;
	}
	double error_was = fabs(number(p->before, ERROR)), error_is = fabs(number(p->after, ERROR));
	if (error_is > least_error * error_was || (isnan(error_is) && !isnan(error_was))) {
		tell("WORSE", p, error_was, error_is, unit, of);
		r->worse++;
	} else if (error_is * least_error < error_was) {
		tell("better", p, error_was, error_is, unit, of);
		r->better++;
	}
}

static void match(struct result *r, const char *name, double slower, const struct csv *before, const struct csv *after)
{
	for (int i = 0; i < after->n; i++) {
		const struct csv_row *old = find(before, &after->rows[i]);
		r->added += !old;
		if (!old)
			continue;
		r->pairs = mem_grow(r->pairs, (size_t)r->n + 1, sizeof *r->pairs);
		r->pairs[r->n++] = (struct pair){ old, &after->rows[i], name, slower };
	}
	for (int i = 0; i < before->n; i++)
		if (!find(after, &before->rows[i])) {
			printf("gone    %s: %s, %s, %s\n", name, before->rows[i].cell[TABLE], before->rows[i].cell[METHOD], before->rows[i].cell[SETTING]);
			r->gone++;
		}
}

/* A bar that was reached and is no longer. */
static void judge_goals(struct result *r, const char *name, const struct csv *before, const struct csv *after)
{
	for (int i = 0; i < after->n; i++)
		for (int j = 0; j < before->n; j++) {
			char *const *is = after->rows[i].cell, *const *was = before->rows[j].cell;
			if (strcmp(is[0], was[0]) != 0 || strcmp(is[4], was[4]) == 0)
				continue;
			bool lost = !strcmp(was[4], "yes");
			printf("%s %s: %s: %s -> %s %s\n", lost ? "MISSED " : "reached", name, is[0], was[2], is[2], is[3]);
			r->worse += lost;
			r->better += !lost;
		}
}

static bool is_table(const char *name)
{
	size_t n = strlen(name);
	return n > 4 && !strcmp(name + n - 4, ".csv") && !(n > 10 && !strcmp(name + n - 10, ".goals.csv"));
}

static void load_pair(struct csv two[2], const char *const dir[2], const char *name, int stem, const char *tail)
{
	for (int k = 0; k < 2; k++) {
		char *path = mem_printf("%s/%.*s%s", dir[k], stem, name, tail);
		struct err none = { 0 };
		if (!csv_load(&two[k], path, &none))
			two[k] = (struct csv){ 0 };
		free(path);
	}
}

static bool compare(const char *const dir[2], struct err *err)
{
	struct file_list list;
	if (!file_list(&list, dir[1], err))
		return false;
	struct result r = { 0 };
	struct csv (*tables)[2] = mem_new((size_t)list.n + 1, sizeof *tables);
	for (int i = 0; i < list.n; i++) {
		struct csv goals[2];
		int stem = (int)strlen(list.names[i]) - 4;
		if (!is_table(list.names[i]))
			continue;
		load_pair(tables[i], dir, list.names[i], stem, ".csv");
		load_pair(goals, dir, list.names[i], stem, ".goals.csv");
		if (tables[i][0].n) {
			match(&r, list.names[i], machine(dir, list.names[i], stem), &tables[i][0], &tables[i][1]);
			judge_goals(&r, list.names[i], &goals[0], &goals[1]);
		}
		csv_free(&goals[0]);
		csv_free(&goals[1]);
	}
	double *slower = mem_new((size_t)r.n + 1, sizeof *slower);
	for (int i = 0; i < r.n; i++) {
		judge(&r, &r.pairs[i]);
		slower[i] = r.pairs[i].slower;
	}
	printf("%d rows in both (machine %.2f times as slow): %d worse, %d better; %d gone, %d new\n", r.n, r.n ? stats_median(r.n, slower) : 1,
	       r.worse, r.better, r.gone, r.added);
	free(slower);
	if (!r.n)
		err_set(err, "%s, %s: no row in both: run make bench in both", dir[0], dir[1]);
	for (int i = 0; i < list.n; i++)
		for (int k = 0; k < 2; k++)
			csv_free(&tables[i][k]);
	free(tables);
	free(r.pairs);
	file_list_free(&list);
	return !r.worse && !err_is(err);
}

int main(int argc, char **argv)
{
	struct err err = { 0 };
	if (argc != 3) {
		fprintf(stderr, "usage: compare BEFORE AFTER: folders that make bench wrote\n");
		return 2;
	}
	bool ok = compare((const char *const[2]){ argv[1], argv[2] }, &err);
	if (err_is(&err))
		fprintf(stderr, "compare: %s\n", err.msg);
	return !ok;
}
