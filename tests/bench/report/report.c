/* report: joins bench/NAME.csv and NAME.goals.csv of all benchmarks into bench/README.md and one plot of error
 * against time for every table that has both. Names the goals that were missed last; exit status 1 where there are any.
 *
 *     report --out=bench --compiler="gcc ..." --flags="-O3 ..."
 */
#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/file.h"
#include "base/mem.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/bench/csv.h"
#include "tests/lib/bench/plot.h"

/* The value of the first "key : value" line in a file of /proc; "unknown" where there is none. */
static char *proc_value(const char *path, const char *key)
{
	FILE *f = fopen(path, "r");
	char line[1024], *found = 0;
	while (f && !found && fgets(line, sizeof line, f)) {
		char *colon = strchr(line, ':');
		if (!strncmp(line, key, strlen(key)) && colon) {
			colon += 1 + strspn(colon + 1, " \t");
			colon[strcspn(colon, "\n")] = 0;
			found = mem_str(colon);
		}
	}
	if (f)
		fclose(f);
	return found ? found : mem_str("unknown");
}

static void write_machine(FILE *md, const char *compiler, const char *flags)
{
	char *cpu = proc_value("/proc/cpuinfo", "model name"), *memory = proc_value("/proc/meminfo", "MemTotal");
	char *features = proc_value("/proc/cpuinfo", "flags");
	const char *vectors = strstr(features, "avx512f") ? "AVX-512" : strstr(features, "avx2") ? "AVX2" : "no AVX2";
	fprintf(md, "# Benchmarks\n\nMade by `make bench`. Times are wall-clock medians; in brackets the quartiles. Every time and the error "
	            "beside it\ncome from the same run.\n\n"
	            "| | |\n|---|---|\n| processor | %s, %ld processors, %s |\n| memory | %s |\n| compiler | %s |\n| flags | `%s` |\n\n",
	        cpu, sysconf(_SC_NPROCESSORS_ONLN), vectors, memory, compiler, flags);
	free(cpu);
	free(memory);
	free(features);
}

/* Text in a cell of a Markdown table. */
static const char *cell_text(char out[256], const char *text)
{
	size_t n = 0;
	for (; *text && n < 250; text++) {
		if (*text == '|')
			out[n++] = '\\';
		out[n++] = *text;
	}
	out[n] = 0;
	return out;
}

static void write_goals(FILE *md, int n, const struct csv goals[], const char *const names[])
{
	int reached = 0, total = 0;
	for (int i = 0; i < n; i++)
		for (int r = 0; r < goals[i].n; r++, total++)
			reached += !strcmp(goals[i].rows[r].cell[4], "yes");
	fprintf(md, "## Goals: %d of %d reached\n\n| | measure | to reach | got | benchmark |\n|---|---|---|---|---|\n", reached,
	        total);
	for (int i = 0; i < n; i++)
		for (int r = 0; r < goals[i].n; r++) {
			char *const *c = goals[i].rows[r].cell, measure[256], reach[256];
			fprintf(md, "| %s | %s | %s | %.4g %s | %s |\n", !strcmp(c[4], "yes") ? "reached" : "**missed**",
			        cell_text(measure, c[0]), cell_text(reach, c[1]), csv_number(c[2]), c[3], names[i]);
		}
	printf("goals: %d of %d reached\n", reached, total);
}

static void write_table(FILE *md, const struct csv *csv, int first)
{
	const struct csv_row *head = &csv->rows[first];
	fprintf(md, "\n### %s\n\n| method | setting | time | a | error | of |\n|---|---|---|---|---|---|\n", head->cell[TABLE]);
	for (int i = first; i < csv->n; i++) {
		char *const *c = csv->rows[i].cell;
		char median[32], low[32], high[32], error[64] = "-";
		if (!csv_same(head, &csv->rows[i], TABLE))
			continue;
		if (*c[ERROR])
			snprintf(error, sizeof error, "%.3g %.40s", csv_number(c[ERROR]), c[UNIT]);
		char method[256], setting[256];
		fprintf(md, "| %s | %s | **%s**", cell_text(method, c[METHOD]), cell_text(setting, c[SETTING]), bench_seconds(median, csv_number(c[MEDIAN])));
		if (*c[LOW] && *c[HIGH])
			fprintf(md, " (%s .. %s)", bench_seconds(low, csv_number(c[LOW])),
			        bench_seconds(high, csv_number(c[HIGH])));
		fprintf(md, " | %s | %s | %s |\n", c[PER], error, c[ERROR_OF]);
	}
}

/* Plots of the table that begins with row `first`: one for each kind of error that at least two rows have. */
static void write_plots(FILE *md, const struct csv *csv, int first, const char *name, const char *out)
{
	for (int i = first; i < csv->n; i++) {
		const struct csv_row *r = &csv->rows[i];
		int same_before = 0, same_all = 0;
		for (int j = first; j < csv->n; j++)
			if (plot_shares(r, &csv->rows[j]) && plot_has(&csv->rows[j])) {
				same_all++;
				same_before += j < i;
			}
		if (!csv_same(r, &csv->rows[first], TABLE) || !plot_has(r) || same_before || same_all < 2)
			continue;
		char *file = mem_printf("%s-%s-%s.png", name, r->cell[TABLE], r->cell[ERROR_OF]);
		for (char *c = file; *c; c++)
			*c = isalnum((unsigned char)*c) || *c == '.' ? (char)tolower((unsigned char)*c) : '-';
		char *path = mem_printf("%s/%s", out, file);
		if (plot_write(csv, r, path))
			fprintf(md, "\n![%s against time](%s)\n", r->cell[ERROR_OF], file);
		free(path);
		free(file);
	}
}

static void write_tables(FILE *md, const struct csv *csv, const char *name, const char *out)
{
	char *path = mem_printf("%s/%s.reps", out, name), *reps = 0;
	size_t size;
	struct err none = { 0 };
	fprintf(md, "\n## %s\n", name);
	if (file_read(&reps, &size, path, 64, &none) && *reps != '0')
		fprintf(md, "\n%s repetitions.\n", reps);
	free(reps);
	free(path);
	char *storage = mem_printf("%s/%s-storage.svg", out, name);
	if (file_exists(storage))
		fprintf(md, "\n![storage, error and time](%s-storage.svg)\n", name);
	free(storage);
	for (int i = 0; i < csv->n; i++) {
		bool seen = false;
		for (int j = 0; j < i && !seen; j++)
			seen = csv_same(&csv->rows[i], &csv->rows[j], TABLE);
		if (seen)
			continue;
		write_table(md, csv, i);
		write_plots(md, csv, i, name, out);
	}
}

static bool ends_with(const char *s, const char *tail)
{
	size_t n = strlen(s), m = strlen(tail);
	return n > m && !strcmp(s + n - m, tail);
}

/* How many goals were missed; names them. */
static int name_missed(int n, const struct csv goals[], const char *const names[])
{
	int missed = 0;
	for (int i = 0; i < n; i++)
		for (int r = 0; r < goals[i].n; r++) {
			char *const *c = goals[i].rows[r].cell;
			if (!strcmp(c[4], "yes"))
				continue;
			printf("missed: bench-%s: %s: %s; got %.4g %s\n", names[i], c[0], c[1], csv_number(c[2]), c[3]);
			missed++;
		}
	return missed;
}

/* missed: so many goals. */
static bool report(int *missed, const char *out, const char *compiler, const char *flags, struct err *err)
{
	struct file_list list;
	if (!file_list(&list, out, err))
		return false;
	struct csv *rows = mem_new((size_t)list.n, sizeof *rows), *goals = mem_new((size_t)list.n, sizeof *goals);
	const char **names = mem_new((size_t)list.n, sizeof *names);
	int n = 0;
	for (int i = 0; i < list.n && !err_is(err); i++) {
		if (!ends_with(list.names[i], ".csv") || ends_with(list.names[i], ".goals.csv"))
			continue;
		list.names[i][strlen(list.names[i]) - 4] = 0;
		names[n] = list.names[i];
		char *path = mem_printf("%s/%s.csv", out, names[n]), *bars = mem_printf("%s/%s.goals.csv", out, names[n]);
		csv_load(&rows[n], path, err);
		csv_load(&goals[n++], bars, err);
		free(path);
		free(bars);
	}
	char *text = 0;
	size_t size = 0;
	FILE *md = open_memstream(&text, &size);
	write_machine(md, compiler, flags);
	write_goals(md, n, goals, names);
	for (int i = 0; i < n; i++)
		write_tables(md, &rows[i], names[i], out);
	fclose(md);
	char *path = mem_printf("%s/README.md", out);
	bool ok = !err_is(err) && file_write(path, text, size, err);
	if (ok)
		printf("tables and plots: %s\n", path);
	*missed = name_missed(n, goals, names);
	for (int i = 0; i < n; i++) {
		csv_free(&rows[i]);
		csv_free(&goals[i]);
	}
	free(rows);
	free(goals);
	free(names);
	free(text);
	free(path);
	file_list_free(&list);
	return ok;
}

int main(int argc, char **argv)
{
	const char *out = "bench", *compiler = "", *flags = "";
	for (int i = 1; i < argc; i++) {
		if (!strncmp(argv[i], "--out=", 6))
			out = argv[i] + 6;
		else if (!strncmp(argv[i], "--compiler=", 11))
			compiler = argv[i] + 11;
		else if (!strncmp(argv[i], "--flags=", 8))
			flags = argv[i] + 8;
	}
	struct err err = { 0 };
	int missed;
	if (report(&missed, out, compiler, flags, &err))
		return missed ? 1 : 0;
	fprintf(stderr, "report: %s\n", err.msg);
	return 1;
}
