#include "tests/lib/bench/plot.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/mem.h"

bool csv_same(const struct csv_row *a, const struct csv_row *b, int column)
{
	return !strcmp(a->cell[column], b->cell[column]);
}

bool plot_shares(const struct csv_row *a, const struct csv_row *b)
{
	return csv_same(a, b, TABLE) && csv_same(a, b, PER) && csv_same(a, b, UNIT) && csv_same(a, b, ERROR_OF);
}

bool plot_has(const struct csv_row *r)
{
	return csv_number(r->cell[MEDIAN]) > 0 && csv_number(r->cell[ERROR]) >= 0;
}

/* A gnuplot string: single quotes, doubled inside. */
static void quoted(FILE *gp, const char *text)
{
	fputc('\'', gp);
	for (; *text; text++)
		fputs(*text == '\'' ? "''" : (char[]){ *text, 0 }, gp);
	fputc('\'', gp);
}

/* Errors over more than a decade and a half stand on a logarithmic axis; *least: where one of exactly zero is drawn. */
static bool is_logarithmic(const struct csv *csv, const struct csv_row *head, double *least)
{
	double lo = INFINITY, hi = 0;
	for (int i = 0; i < csv->n; i++) {
		double e = csv_number(csv->rows[i].cell[ERROR]);
		if (plot_shares(head, &csv->rows[i]) && plot_has(&csv->rows[i]) && e > 0) {
			lo = fmin(lo, e);
			hi = fmax(hi, e);
		}
	}
	bool logarithmic = hi > 30 * lo && strcmp(head->cell[UNIT], "%");
	*least = !logarithmic ? 0 : isfinite(lo) ? lo / 10 : 1e-17;
	return logarithmic;
}

static bool in_series(const struct csv *csv, const struct csv_row *head, int first, int i)
{
	const struct csv_row *r = &csv->rows[i];
	return plot_shares(head, r) && plot_has(r) && csv_same(&csv->rows[first], r, METHOD);
}

struct series {
	int first, n;
	bool ordered;  // slower from row to row: settings of one knob, worth a line
};

/* Rows of one method as a data block; false when row `first` is not the method's first in this plot. Of long series
 * the ends alone are labelled. */
static bool plot_series(FILE *gp, const struct csv *csv, const struct csv_row *head, struct series *series, int block,
                        double least)
{
	int first = series->first, k = 0;
	double before = 0;
	*series = (struct series){ first, 0, true };
	for (int i = 0; i < csv->n; i++) {
		if (!in_series(csv, head, first, i))
			continue;
		if (i < first)
			return false;
		double t = csv_number(csv->rows[i].cell[MEDIAN]);
		series->ordered &= t > 0.98 * before;
		before = t;
		series->n++;
	}
	fprintf(gp, "$d%d << EOD\n", block);
	for (int i = first; i < csv->n; i++) {
		const struct csv_row *r = &csv->rows[i];
		if (!in_series(csv, head, first, i))
			continue;
		double e = csv_number(r->cell[ERROR]);
		fprintf(gp, "%.9g %.9g \"", csv_number(r->cell[MEDIAN]), e > 0 ? e : least);
		bool labelled = series->n <= 4 || (series->ordered && (k == 0 || k == series->n - 1));
		for (const char *s = labelled ? r->cell[SETTING] : ""; *s; s++)
			fputc(*s == '"' || *s == '\\' ? '\'' : *s, gp);
		fputs("\"\n", gp);
		k++;
	}
	fputs("EOD\n", gp);
	return true;
}

/* The front, as steps: what no other row beats in time and error together. */
static void plot_front(FILE *gp, const struct csv *csv, const struct csv_row *head, double least)
{
	double after = -1, error = INFINITY;
	fputs("$front << EOD\n", gp);
	for (;;) {
		const struct csv_row *next = 0;
		for (int i = 0; i < csv->n; i++) {
			const struct csv_row *r = &csv->rows[i];
			double t = csv_number(r->cell[MEDIAN]), best = next ? csv_number(next->cell[MEDIAN]) : INFINITY;
			if (!plot_shares(head, r) || !plot_has(r) || !(csv_number(r->cell[ERROR]) < error) || !(t > after))
				continue;
			if (t < best || (t == best && csv_number(r->cell[ERROR]) < csv_number(next->cell[ERROR])))
				next = r;
		}
		if (!next)
			break;
		after = csv_number(next->cell[MEDIAN]);
		error = csv_number(next->cell[ERROR]);
		fprintf(gp, "%.9g %.9g\n", after, error > 0 ? error : least);
	}
	fputs("EOD\n", gp);
}

bool plot_write(const struct csv *csv, const struct csv_row *head, const char *png)
{
	FILE *gp = popen("gnuplot", "w");
	if (!gp)
		return false;
	struct series series[64];
	double least;
	bool logarithmic = is_logarithmic(csv, head, &least);
	int n = 0;
	for (int i = 0; i < csv->n && n < COUNT(series); i++) {
		series[n].first = i;
		if (plot_shares(head, &csv->rows[i]) && plot_has(&csv->rows[i]) && plot_series(gp, csv, head, &series[n], n, least))
			n++;
	}
	plot_front(gp, csv, head, least);
	fputs("set terminal pngcairo noenhanced size 1300,700 font 'sans,11'\nset output ", gp);
	quoted(gp, png);
	fprintf(gp, "\nset logscale x\nset grid\nset key outside right top width -2\n"
	            "set offsets graph 0.05, graph 0.12, graph 0.08, graph 0.02\nset format x '%%.0s %%cs'\n%s\n"
	            "set xlabel 'time a %s'\nset ylabel '%s, %s'\nset title ",
	        logarithmic ? "set logscale y\nset format y '%.0e'" : "set yrange [0:*]", head->cell[PER], head->cell[ERROR_OF],
	        head->cell[UNIT]);
	quoted(gp, head->cell[TABLE]);
	fputs("\nplot $front using 1:2 with steps lw 2 lc rgb '#bbbbbb' title 'front'", gp);
	for (int i = 0; i < n; i++) {
		fprintf(gp, ", $d%d using 1:2 with %s pt %d ps 1.4 lc %d title ", i,
		        series[i].ordered ? "linespoints" : "points", i % 12 + 4, i + 1);
		quoted(gp, csv->rows[series[i].first].cell[METHOD]);
		fprintf(gp, ", $d%d using 1:2:3 with labels font ',8' offset 0.6,0.6 left tc lt %d notitle", i, i + 1);
	}
	fputs("\n", gp);
	return pclose(gp) == 0;
}
