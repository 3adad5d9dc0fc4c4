/* differ: two artifacts compared number by number, for builds of two compilers.
 *
 *     differ FILE FILE MOST SHARE
 *
 * Every number of a file belongs to a series (a channel of a map, a column, an array, a key): what it is off by is measured in
 * the series' largest, or a millionth. A series agrees when no more than SHARE of its numbers is off by more than MOST, or is a number in one
 * file and none in the other. Texts have to be the same but for what names programs and inputs (made_by and hashes). One line;
 * exit 1 when a series does not agree.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "tests/lib/score/series.h"

struct worst {
	double off, beyond;  // of all series; the largest share beyond MOST
	char where[200], most_where[200];
};

static void judge(struct worst *w, const struct series *a, const struct series *b, double most)
{
	double scale = 1e-6;  // mm, px, degrees: below that is nothing
	long beyond = 0;
	for (long i = 0; i < a->n; i++)
		if (isfinite(a->v[i]))
			scale = fmax(scale, fabs(a->v[i]));
	for (long i = 0; i < a->n; i++) {
		bool number = isfinite(a->v[i]);
		double off = number != (bool)isfinite(b->v[i]) ? INFINITY : number ? fabs(a->v[i] - b->v[i]) / scale : 0;
		beyond += off > most;
		if (off > w->off) {
			w->off = off;
			snprintf(w->where, sizeof w->where, "%s", a->name);
		}
	}
	double share = a->n ? (double)beyond / (double)a->n : 0;
	if (share > w->beyond) {
		w->beyond = share;
		snprintf(w->most_where, sizeof w->most_where, "%s", a->name);
	}
}

/* False where the files are of another kind or shape. */
static bool compare(struct worst *w, const struct series_list *a, const struct series_list *b, double most)
{
	*w = (struct worst){ 0 };
	if (a->n != b->n || strcmp(a->text ? a->text : "", b->text ? b->text : "") != 0)
		return false;
	for (int i = 0; i < a->n; i++) {
		if (strcmp(a->of[i].name, b->of[i].name) != 0 || a->of[i].n != b->of[i].n)
			return false;
		judge(w, &a->of[i], &b->of[i], most);
	}
	return true;
}

static bool one_file(const char *a, const char *b, const char *rel, double most, double share)
{
	struct series_list x, y;
	struct worst w;
	struct err err = { 0 };
	bool read = series_read(&x, a, &err), also = series_read(&y, b, &err), same = read && also && compare(&w, &x, &y, most);
	bool ok = same && w.beyond <= share;
	if (!read || !also)
		printf("  BAD     %s: %s\n", rel, err.msg);
	else if (!same)
		printf("  BAD     %s: other keys, texts or sizes\n", rel);
	else
		printf("  %s %s: worst %.2g of the largest (%s); %.3g %% beyond %g%s%s\n", ok ? "within " : "BEYOND ", rel, w.off, w.where, 100 * w.beyond, most,
		       *w.most_where ? ", " : "", w.most_where);
	series_free(&x);
	series_free(&y);
	return ok;
}

int main(int argc, char **argv)
{
	if (argc != 5) {
		fprintf(stderr, "usage: differ FILE FILE MOST SHARE\n");
		return 2;
	}
	return !one_file(argv[1], argv[2], argv[1], atof(argv[3]), atof(argv[4]));
}
