#include "tests/lib/bench/bench.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "base/file.h"
#include "base/mem.h"

/* One benchmark a process: what it has measured so far. */
static struct {
	const char *name, *out;
	bool quick;
	char *rows, *goals, *missed;
	size_t rows_size, goals_size, missed_size;
	FILE *rows_file, *goals_file, *missed_file;
	char table[80];  // last one printed: its head is printed once
	int least_reps, most_reps, n_yard;
	double *yard;    // seconds of the yardstick, all samples
	volatile double end_of_loop;
} bench;

static double now_s(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The same work in every revision, about a millisecond: how fast the processor is just now. Each step waits for the one
 * before, so that no compiler makes it shorter. */
static void yardstick(int samples)
{
	bench.yard = mem_grow(bench.yard, (size_t)(bench.n_yard + samples), sizeof *bench.yard);
	for (int i = 0; i < samples; i++) {
		double x = 0.3, start = now_s();
		for (int k = 0; k < 200000; k++)
			x = 3.9 * x * (1 - x);
		bench.end_of_loop = x;
		bench.yard[bench.n_yard++] = now_s() - start;
	}
}

void bench_open(const char *name, int argc, char **argv)
{
	bench.name = name;
	bench.out = "bench";
	for (int i = 1; i < argc; i++)
		if (!strcmp(argv[i], "--quick"))
			bench.quick = true;
		else if (!strncmp(argv[i], "--out=", 6))
			bench.out = argv[i] + 6;
		else {
			fprintf(stderr, "%s: %s: must be --quick or --out=DIR\n", argv[0], argv[i]);
			exit(2);
		}
	bench.rows_file = open_memstream(&bench.rows, &bench.rows_size);
	bench.goals_file = open_memstream(&bench.goals, &bench.goals_size);
	bench.missed_file = open_memstream(&bench.missed, &bench.missed_size);
	fputs("table,method,setting,per,median_s,low_s,high_s,error,error_unit,error_of\n", bench.rows_file);
	fputs("measure,reach,got,unit,reached\n", bench.goals_file);
	bench.least_reps = bench.most_reps = 0;
	yardstick(10);
	printf("== %s%s\n", name, bench.quick ? " (quick)" : "");
}

bool bench_quick(void)
{
	return bench.quick;
}

const char *bench_out(void)
{
	return bench.out;
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

/* Linear between the two samples nearest to the share q. */
static double quantile(int n, const double sorted[], double q)
{
	double at = q * (n - 1);
	int i = (int)at < n - 1 ? (int)at : n - 1, j = i < n - 1 ? i + 1 : i;
	return sorted[i] + (at - i) * (sorted[j] - sorted[i]);
}

struct bench_time bench_time_of(int n, double seconds[])
{
	if (n < 1)
		return (struct bench_time){ NAN, NAN, NAN };
	bench.most_reps = n > bench.most_reps ? n : bench.most_reps;
	bench.least_reps = bench.least_reps && bench.least_reps < n ? bench.least_reps : n;
	qsort(seconds, (size_t)n, sizeof *seconds, by_value);
	return (struct bench_time){ quantile(n, seconds, 0.5), quantile(n, seconds, 0.25), quantile(n, seconds, 0.75) };
}

struct bench_time bench_time_each(struct bench_time t, double n)
{
	return (struct bench_time){ t.median / n, t.low / n, t.high / n };
}

void bench_times(int n, struct bench_time out[], void (*const fn[])(void *), void *const ctx[], int reps)
{
	reps = reps > 1 ? reps : 1;
	double *seconds = mem_new((size_t)n * (size_t)reps, sizeof *seconds);
	for (int r = -1; r < reps; r++) {  // the first round fills caches and wakes threads
		for (int i = 0; i < n; i++) {
			double start = now_s();
			fn[i](ctx[i]);
			if (r >= 0)
				seconds[(size_t)i * (size_t)reps + (size_t)r] = now_s() - start;
		}
		if (r < 10)
			yardstick(1);
	}
	for (int i = 0; i < n; i++)
		out[i] = bench_time_of(reps, seconds + (size_t)i * (size_t)reps);
	free(seconds);
}

struct bench_time bench_time(void (*fn)(void *), void *ctx, int reps)
{
	struct bench_time out;
	bench_times(1, &out, &fn, &ctx, reps);
	return out;
}

const char *bench_seconds(char out[32], double s)
{
	static const struct {
		double above, scale;
		const char *unit;
	} units[] = { { 1, 1, "s" }, { 1e-3, 1e3, "ms" }, { 1e-6, 1e6, "us" }, { 0, 1e9, "ns" } };
	int u = 0;
	if (!isfinite(s))
		return "-";
	while (u < COUNT(units) - 1 && fabs(s) < units[u].above)
		u++;
	snprintf(out, 32, "%.3g %s", s * units[u].scale, units[u].unit);
	return out;
}

/* One CSV record (RFC 4180): every text quoted; numbers with all their digits, empty for NAN. */
static void csv(FILE *out, const char *types, ...)
{
	va_list ap;
	va_start(ap, types);
	for (const char *t = types; *t; t++) {
		if (t != types)
			fputc(',', out);
		if (*t == 'n') {
			double v = va_arg(ap, double);
			if (!isnan(v))
				fprintf(out, "%.9g", v);
			continue;
		}
		fputc('"', out);
		for (const char *s = va_arg(ap, const char *); *s; s++)
			fputs(*s == '"' ? "\"\"" : (char[]){ *s, 0 }, out);
		fputc('"', out);
	}
	fputc('\n', out);
	va_end(ap);
}

void bench_row(const char *table, const char *method, const char *setting, struct bench_time time, const char *per,
               double error, const char *error_unit, const char *error_of)
{
	char median[32], low[32], high[32];
	csv(bench.rows_file, "ssssnnnnss", table, method, setting, per, time.median, time.low, time.high,
	    error, error_unit, error_of);
	if (strcmp(bench.table, table)) {
		printf("\n%s\n  %-34s %-24s %10s  %-23s %s\n", table, "method", "setting", "median", "quartiles", "error");
		snprintf(bench.table, sizeof bench.table, "%s", table);
	}
	printf("  %-34s %-24s %10s  %10s .. %-9s ", method, setting, bench_seconds(median, time.median),
	       bench_seconds(low, time.low), bench_seconds(high, time.high));
	if (isnan(error))
		printf("-\n");
	else
		printf("%.3g %s (%s)\n", error, error_unit, error_of);
	fflush(stdout);
}

void bench_goal(const char *measure, const char *reach, double got, const char *unit, bool reached)
{
	csv(bench.goals_file, "ssnss", measure, reach, got, unit, reached ? "yes" : "no");
	printf("  goal %-7s %s: %s; got %.4g %s\n", reached ? "reached" : "MISSED", measure, reach, got, unit);
	if (!reached)
		fprintf(bench.missed_file, "missed: %s: %s; got %.4g %s\n", measure, reach, got, unit);
	fflush(stdout);
}

static bool write_out(const char *suffix, const char *text, size_t size, struct err *err)
{
	char *path = mem_printf("%s/%s%s", bench.out, bench.name, suffix);
	bool ok = file_write(path, text, size, err);
	free(path);
	return ok;
}

int bench_close(void)
{
	struct err err = { 0 };
	fclose(bench.rows_file);
	fclose(bench.goals_file);
	fclose(bench.missed_file);
	yardstick(10);
	qsort(bench.yard, (size_t)bench.n_yard, sizeof *bench.yard, by_value);
	char *reps = mem_printf("%d to %d", bench.least_reps, bench.most_reps);
	char *yard = mem_printf("%.9g\n", quantile(bench.n_yard, bench.yard, 0.5));
	bool ok = write_out(".csv", bench.rows, bench.rows_size, &err)
	          && write_out(".goals.csv", bench.goals, bench.goals_size, &err)
	          && write_out(".reps", reps, strlen(reps), &err) && write_out(".yard", yard, strlen(yard), &err);
	free(reps);
	free(yard);
	free(bench.yard);
	if (!ok)
		fprintf(stderr, "%s\n", err.msg);
	printf("%s", bench.missed);
	bool reached = !bench.missed_size;
	free(bench.rows);
	free(bench.goals);
	free(bench.missed);
	return ok && reached ? 0 : 1;
}

const char *bench_data(const char *rel)
{
	static char ring[8][4096];
	static int next;
	char *path = ring[next++ % COUNT(ring)];
	const char *root = getenv("EYEWRIGHT_DATA");
	snprintf(path, sizeof ring[0], "%s/%s", root && *root ? root : "../shared/data", rel);
	return access(path, R_OK) ? 0 : path;
}
