/* The opening of an eye at rest, as the front sees it. */
#include <math.h>
#include <string.h>

#include "base/mem.h"
#include "rig/hair/impl.h"

/* Rows of the front over what can be an eye's opening, units apart; what is open less is a corner. */
enum { COLUMNS = FRONT_COLUMNS, ROWS = 97, SMOOTH = 5 };
static const double row = 0.25, least_open = 0.6, finest = 0.005;

static bool open_at(const struct front *f, double x, double y)
{
	struct front_hit hit;
	const double globe = front_globe(f, x, y);
	return isfinite(globe) && (!front_skin(&hit, f, x, y) || hit.z < globe);
}

/* Between y, which is open, and `beyond`, which is not. */
static double edge(const struct front *f, double x, double y, double beyond)
{
	while (fabs(beyond - y) > finest) {
		const double mid = 0.5 * (y + beyond);
		if (open_at(f, x, mid))
			y = mid;
		else
			beyond = mid;
	}
	return y;
}

static void look(struct front_opening *o, const struct front *f, int i)
{
	int best = 0, at = 0, run = 0;
	for (int k = 0; k <= ROWS; k++) {
		const bool open = k < ROWS && open_at(f, front_column(i), row * (k - ROWS / 2));
		if (!open && run > best) {
			best = run;
			at = k;
		}
		run = open ? run + 1 : 0;
	}
	o->low[i] = o->high[i] = 0;
	if (!best)
		return;
	const double top = row * (at - 1 - ROWS / 2), bottom = row * (at - best - ROWS / 2);
	o->high[i] = edge(f, front_column(i), top, top + row);
	o->low[i] = edge(f, front_column(i), bottom, bottom - row);
}

static void smoothed(double y[COLUMNS], int first, int last)
{
	double out[COLUMNS];
	for (int i = first; i <= last; i++) {
		const int reach = i - first < SMOOTH ? i - first : SMOOTH, k = last - i < reach ? last - i : reach;
		out[i] = 0;
		for (int j = i - k; j <= i + k; j++)
			out[i] += y[j] / (2 * k + 1);
	}
	for (int i = first; i <= last; i++)
		y[i] = out[i];
}

bool front_open(struct front_opening *o, const struct front *f)
{
	int widest = 0;
#pragma omp parallel for schedule(dynamic, 8)
	for (int i = 0; i < COLUMNS; i++)
		look(o, f, i);
	for (int i = 0; i < COLUMNS; i++)
		widest = o->high[i] - o->low[i] > o->high[widest] - o->low[widest] ? i : widest;
	if (!(o->high[widest] - o->low[widest] > 2 * least_open))
		return false;
	for (o->first = widest; o->first > 0 && o->high[o->first - 1] - o->low[o->first - 1] > least_open; o->first--)
		;
	for (o->last = widest; o->last + 1 < COLUMNS && o->high[o->last + 1] - o->low[o->last + 1] > least_open; o->last++)
		;
	smoothed(o->high, o->first, o->last);
	smoothed(o->low, o->first, o->last);
	return o->last - o->first > 50;
}

/* The skin at an end of a column's opening. */
static bool touches(struct hair_rim *rim, const struct front *f, const struct front_opening *o, int column, bool upper)
{
	static const double within = 0.04, step = 0.04;
	struct front_hit hit;
	for (int k = 0; k < 25; k++)
		if (front_skin(&hit, f, front_column(column), upper ? o->high[column] + within + k * step : o->low[column] - within - k * step)) {
			memcpy(rim->vertex[upper], f->rig->faces[hit.face], sizeof rim->vertex[upper]);
			memcpy(rim->weight[upper], hit.weight, sizeof rim->weight[upper]);
			return true;
		}
	return false;
}

void hairs_find_rims(struct hairs *h, const struct front *f, const struct front_opening *o)
{
	const int first = h->n_rims;
	h->rim = mem_grow(h->rim, (size_t)h->n_rims + HAIR_RIMS, sizeof *h->rim);
	for (int i = 0; i < HAIR_RIMS; i++) {
		struct hair_rim rim = { .side = f->side };
		const int column = o->first + (int)lrint((o->last - o->first) * (double)i / (HAIR_RIMS - 1));
		if (touches(&rim, f, o, column, false) && touches(&rim, f, o, column, true))
			h->rim[h->n_rims++] = rim;
	}
	for (int i = first; i < h->n_rims; i++)  // a corner where no skin is near is none
		h->rim[i].along = (float)(i - first) / fmaxf((float)(h->n_rims - 1 - first), 1);
}
