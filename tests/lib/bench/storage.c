#include "tests/lib/bench/storage.h"

#include <math.h>
#include <stdio.h>

/* Whether no other point is at least as good in all three and better in one. */
static bool on_front(int n, const struct storage_point p[], int i)
{
	for (int j = 0; j < n; j++) {
		bool no_worse = p[j].bytes <= p[i].bytes && p[j].seconds <= p[i].seconds && p[j].error <= p[i].error;
		if (no_worse && (p[j].bytes < p[i].bytes || p[j].seconds < p[i].seconds || p[j].error < p[i].error))
			return false;
	}
	return true;
}

/* Nothing stored stands at one byte; the area of a mark goes with the logarithm of the time. */
static void put(FILE *gp, const struct storage_point *p)
{
	fprintf(gp, "%g %g %g \"%.0f ns\"\n", fmax(p->bytes, 1), p->error, 0.6 + 0.8 * log10(fmax(p->seconds * 1e9, 1)), p->seconds * 1e9);
}

bool storage_plot(const char *out, const char *name, const char *title, const char *error_axis, int n, const struct storage_point points[])
{
	FILE *gp = popen("gnuplot", "w");
	int methods = 0;
	const char *of[32];
	if (!gp)
		return false;
	for (int i = 0; i < n && methods < 32; i++) {
		bool seen = false;
		for (int k = 0; k < methods; k++)
			seen |= of[k] == points[i].method;
		if (seen)
			continue;
		of[methods] = points[i].method;
		fprintf(gp, "$d%d << EOD\n", methods++);
		for (int j = i; j < n; j++)
			if (points[j].method == points[i].method)
				put(gp, &points[j]);
		fputs("EOD\n", gp);
	}
	fputs("$front << EOD\n", gp);
	for (int i = 0; i < n; i++)
		if (on_front(n, points, i))
			put(gp, &points[i]);
	fputs("EOD\n", gp);
	fprintf(gp, "set terminal svg noenhanced size 1100,700 font 'sans,12'\nset output '%s/%s.svg'\nset logscale xy\nset grid\nset key outside right top\n"
	            "set offsets graph 0.05, graph 0.1, graph 0.05, graph 0.05\nset format y '%%.0e'\nset title '%s'\nset xlabel 'bytes stored (1: none)'\n"
	            "set ylabel '%s'\nplot $front using 1:2:($3*1.7) with points pt 6 ps variable lc rgb 'black' title 'on the front'", out, name, title, error_axis);
	for (int k = 0; k < methods; k++)
		fprintf(gp, ", $d%d using 1:2:3 with points pt 7 ps variable lc %d title '%s', $d%d using 1:2:4 with labels font ',9' offset 1,0.7 left notitle", k, k + 1, of[k], k);
	fputs("\n", gp);
	return pclose(gp) == 0;
}
