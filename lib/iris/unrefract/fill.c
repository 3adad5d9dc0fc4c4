/* What no photograph shows of an iris, continued from what they show. The ring is unrolled (polar.h) and filled strip by strip, each with
 * the piece of the same rows, some angle away and plain or mirrored, that agrees best with what is seen beside it. So fibres stay
 * fibres, and nothing is smeared. Neighbouring strips are cross-faded so that contrast is kept. At last a smooth surface takes the step
 * to what is seen away (a membrane by push and pull, after Gortler et al., "The lumigraph", 1996).
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "iris/unrefract/polar.h"
#include "math/stats.h"

enum { STRIP_DEG = 12, OVERLAP_DEG = 3 };
static const double again = 0.5;  // what each time that a piece was taken before costs, of the pattern's variance: repeated pieces show as spokes

/* What is laid over the polar sheet: sum of weighted patterns, and the sum of squared weights, [rows][columns][4]. */
struct laid {
	const struct polar *sheet;
	const float (*bounds)[2];  // of each colour (bounds_of)
	float *sum;
	int *taken;  // [columns]: how often a column was taken, in earlier passes, too
};

/* Columns from .. from + count, to be filled; the strip reaches `overlap` farther to either side. */
struct strip {
	int from, count, overlap;
};

/* Where a strip's pattern is taken from: its columns turned, or mirrored about its middle first. */
struct source {
	int turn;
	bool mirror;
	double cost;
};

static int source_column(const struct strip *s, const struct source *source, int column)
{
	return source->turn + (source->mirror ? 2 * s->from + s->count - 1 - column : column);
}

/* How often a source's columns were taken before, in the mean. */
static double times_taken(const struct laid *laid, const struct strip *s, const struct source *source)
{
	long sum = 0;
	for (int j = s->from; j < s->from + s->count; j++)
		sum += laid->taken[source_column(s, source, j) & (laid->sheet->columns - 1)];
	return (double)sum / s->count;
}

/* Mismatch with what is seen in and beside the strip. A source that does not show all of it is taken only where none does. */
static double judge(const struct laid *laid, const struct strip *s, const struct source *source, int stride, double variance)
{
	const struct polar *p = laid->sheet;
	double sum = 0;
	long same = 0, wanted = 0, lacking = 0;
	for (int k = stride / 2; k < p->rows; k += stride) {
		if (p->full[k] != k)
			continue;
		for (int j = s->from - s->overlap; j < s->from + s->count + s->overlap; j += stride) {
			int from = source_column(s, source, j);
			bool shown = *polar_kind(p, k, from) == POLAR_SEEN;
			if (*polar_kind(p, k, j) == POLAR_HIDDEN) {
				wanted++;
				lacking += !shown;
			} else if (shown) {
				const float *a = polar_at(p, k, j), *b = polar_at(p, k, from);
				for (int c = 0; c < 3; c++)
					sum += (a[c] - b[c]) * (a[c] - b[c]);
				same++;
			}
		}
	}
	double mean = same ? sum / (double)same : 2 * variance;
	return mean + variance * (again * times_taken(laid, s, source) + (wanted ? 40 * (double)lacking / (double)wanted : 0));
}

static struct source best_source(const struct laid *laid, const struct strip *s, double variance)
{
	const struct polar *p = laid->sheet;
	enum { TURNS = 180 };
	struct source all[2 * TURNS], best = { 0 };
	int step = p->columns / TURNS > 1 ? p->columns / TURNS : 1, least = s->count + s->overlap;
	int stride = (int)fmax(1, sqrt((double)p->rows * (s->count + 2 * s->overlap) / 600));
	best.cost = INFINITY;
#pragma omp parallel for schedule(dynamic, 8)
	for (int i = 0; i < 2 * TURNS; i++) {
		int turn = i / 2 * step;
		bool near = turn < least || turn > p->columns - least;
		all[i] = (struct source){ turn, i % 2, INFINITY };
		if (turn < p->columns && !near)
			all[i].cost = judge(laid, s, &all[i], stride, variance);
	}
	for (int i = 0; i < 2 * TURNS; i++)
		if (all[i].cost < best.cost)
			best = all[i];
	for (int d = step / 2; d > 0 && isfinite(best.cost); d /= 2)
		for (int side = -1; side <= 1; side += 2) {
			struct source try = best;
			try.turn += side * d;
			try.cost = judge(laid, s, &try, stride, variance);
			if (try.cost < best.cost)
				best = try;
		}
	return best;
}

/* Adds the source's pattern, its weight falling towards the strip's ends. */
static void lay(struct laid *laid, const struct strip *s, const struct source *source)
{
	const struct polar *p = laid->sheet;
#pragma omp parallel for schedule(static)
	for (int k = 0; k < p->rows; k++)
		for (int j = s->from - s->overlap; j < s->from + s->count + s->overlap; j++) {
			int from = source_column(s, source, j);
			if (*polar_kind(p, k, from) != POLAR_SEEN)
				continue;
			int end = j - (s->from - s->overlap) < s->from + s->count + s->overlap - 1 - j ? j - (s->from - s->overlap)
			                                                                               : s->from + s->count + s->overlap - 1 - j;
			float w = fminf(1, (end + 0.5f) / (2 * (float)s->overlap)), *sum = laid->sum + 4 * ((long)k * p->columns + (j & (p->columns - 1)));
			for (int c = 0; c < 3; c++)
				sum[c] += w * polar_at(p, k, from)[c];
			sum[3] += w * w;
		}
}

/* One level of the pyramid: values times weight, and weight, [rows][columns][4]. */
struct level {
	int rows, columns;
	float *px;
};

static float *level_at(const struct level *l, int row, int column)
{
	row = row < 0 ? 0 : row >= l->rows ? l->rows - 1 : row;
	return l->px + 4 * ((long)row * l->columns + (column & (l->columns - 1)));
}

static struct level halve(const struct level *fine)
{
	struct level out = { (fine->rows + 1) / 2, fine->columns / 2, 0 };
	out.px = mem_new(4 * (size_t)out.rows * (size_t)out.columns, sizeof *out.px);
#pragma omp parallel for schedule(static)
	for (int k = 0; k < out.rows; k++)
		for (int j = 0; j < out.columns; j++) {
			float *to = level_at(&out, k, j);
			for (int i = 0; i < 4 && 2 * k + i / 2 < fine->rows; i++)
				for (int c = 0; c < 4; c++)
					to[c] += level_at(fine, 2 * k + i / 2, 2 * j + i % 2)[c];
			float limit = fminf(1, 1 / fmaxf(to[3], 1e-9f));
			for (int c = 0; c < 4; c++)
				to[c] *= limit;
		}
	return out;
}

/* Fills what has no weight from the coarser level, bilinearly. */
static void refine(struct level *fine, const struct level *coarse)
{
#pragma omp parallel for schedule(static)
	for (int k = 0; k < fine->rows; k++)
		for (int j = 0; j < fine->columns; j++) {
			float *to = level_at(fine, k, j), rest = 1 - to[3];
			int row = (k + 1) / 2 - 1, column = (j + 1) / 2 - 1;
			float f = k % 2 ? 0.25f : 0.75f, g = j % 2 ? 0.25f : 0.75f;
			for (int c = 0; c < 3 && rest > 0; c++)
				to[c] += rest * ((1 - f) * ((1 - g) * level_at(coarse, row, column)[c] + g * level_at(coarse, row, column + 1)[c])
				                 + f * ((1 - g) * level_at(coarse, row + 1, column)[c] + g * level_at(coarse, row + 1, column + 1)[c]));
			to[3] = 1;
		}
}

/* The smooth surface through what has weight 1, in place. */
static void membrane(struct level *top)
{
	if (top->columns <= 4 || top->rows <= 2) {
		double sum[4] = { 0 };
		for (long i = 0; i < (long)top->rows * top->columns; i++)
			for (int c = 0; c < 4; c++)
				sum[c] += top->px[4 * i + c];
		for (long i = 0; i < (long)top->rows * top->columns; i++) {
			float rest = 1 - top->px[4 * i + 3];
			for (int c = 0; c < 3 && sum[3] > 0; c++)
				top->px[4 * i + c] += rest * (float)(sum[c] / sum[3]);
		}
		return;
	}
	struct level half = halve(top);
	membrane(&half);
	refine(top, &half);
	free(half.px);
}

/* Whether a place that is seen has a hidden one within two steps. */
static bool at_edge(const struct polar *p, int row, int column)
{
	for (int k = row > 2 ? row - 2 : 0; k <= row + 2 && k < p->rows; k++)
		for (int j = column - 2; j <= column + 2; j++)
			if (p->full[k] == k && *polar_kind(p, k, j) == POLAR_HIDDEN)
				return true;
	return false;
}

/* Takes what was laid into the sheet, with the step at the edge of what is seen spread over it. */
static void settle(struct polar *p, const struct laid *laid)
{
	struct level step = { p->rows, p->columns, mem_new(4 * (size_t)p->rows * (size_t)p->columns, sizeof(float)) };
#pragma omp parallel for schedule(static)
	for (int k = 0; k < p->rows; k++)
		for (int j = 0; j < p->columns; j++) {
			const float *sum = laid->sum + 4 * ((long)k * p->columns + j);
			if (*polar_kind(p, k, j) != POLAR_SEEN || !at_edge(p, k, j))
				continue;
			float *to = level_at(&step, k, j), scale = sum[3] > 0 ? 1 / sqrtf(sum[3]) : 0;
			for (int c = 0; c < 3; c++)
				to[c] = polar_at(p, k, j)[c] - scale * sum[c];
			to[3] = 1;
		}
	membrane(&step);
#pragma omp parallel for schedule(static)
	for (int k = 0; k < p->rows; k++)
		for (int j = 0; j < p->columns; j++) {
			const float *sum = laid->sum + 4 * ((long)k * p->columns + j);
			if (*polar_kind(p, k, j) != POLAR_HIDDEN)
				continue;
			float scale = sum[3] > 0 ? 1 / sqrtf(sum[3]) : 0;
			for (int c = 0; c < 3; c++)
				polar_at(p, k, j)[c] = fminf(fmaxf(scale * sum[c] + level_at(&step, k, j)[c], laid->bounds[c][0]), laid->bounds[c][1]);
		}
	free(step.px);
}

/* Rows of which too little is seen, at the pupil's margin and the limbus, go on as the mirror image of those beside them. */
static void mirror_rims(struct polar *p)
{
	for (int k = 0; k < p->rows; k++) {
		int full = p->full[k], from = 2 * full - k;
		from = from < 0 ? 0 : from >= p->rows ? p->rows - 1 : from;
		for (int j = 0; j < p->columns && full != k; j++)
			if (*polar_kind(p, k, j) == POLAR_HIDDEN)
				memcpy(polar_at(p, k, j), polar_at(p, p->full[from] == from ? from : full, j), 3 * sizeof(float));
	}
}

/* Mean square of the pattern, over the colours. */
static double variance_of(const struct polar *p)
{
	double sum = 0;
	long n = 0;
	for (long i = 0; i < (long)p->rows * p->columns; i++)
		if (p->kind[i] == POLAR_SEEN) {
			for (int c = 0; c < 3; c++)
				sum += p->px[3 * i + c] * p->px[3 * i + c];
			n++;
		}
	return n ? fmax(sum / (double)n, 1e-6) : 1e-6;
}

/* What the pattern's colours lie between but for one in a hundred, where it is seen, and a quarter more: beside a reflection's rim a step may be far beyond, and no iris is. */
static void bounds_of(float bounds[3][2], const struct polar *p)
{
	enum { MOST = 1 << 15 };
	const long all = (long)p->rows * p->columns, stride = 1 + all / MOST;
	double *x = mem_array(MOST, sizeof *x);
	for (int c = 0; c < 3; c++) {
		int n = 0;
		for (long i = 0; i < all; i += stride)
			if (p->kind[i] == POLAR_SEEN)
				x[n++] = p->px[3 * i + c];
		const double low = n ? stats_quantile(n, x, 0.005) : -INFINITY, high = n ? stats_quantile(n, x, 0.995) : INFINITY, room = n ? 0.25 * (high - low) : 0;
		bounds[c][0] = (float)(low - room);
		bounds[c][1] = (float)(high + room);
	}
	free(x);
}

static bool column_hides(const struct polar *p, int column)
{
	for (int k = 0; k < p->rows; k++)
		if (p->full[k] == k && *polar_kind(p, k, column) == POLAR_HIDDEN)
			return true;
	return false;
}

/* Fills a run of columns in strips. */
static void fill_run(struct laid *laid, int from, int count, double variance)
{
	const struct polar *p = laid->sheet;
	int n = (count * 360 + STRIP_DEG * p->columns - 1) / (STRIP_DEG * p->columns), overlap = p->columns * OVERLAP_DEG / 360;
	for (int i = 0; i < n; i++) {
		int begin = count * i / n, end = count * (i + 1) / n;
		struct strip s = { from + begin, end - begin, overlap > 1 ? overlap : 1 };
		struct source source = best_source(laid, &s, variance);
		if (!isfinite(source.cost))
			continue;
		lay(laid, &s, &source);
		for (int j = s.from; j < s.from + s.count; j++)
			laid->taken[source_column(&s, &source, j) & (p->columns - 1)]++;
	}
}

/* One pass over all runs of columns with hidden places. Returns whether it has filled any, which count as seen from then on. */
static bool fill_pass(struct polar *p, int *taken, double variance, const float (*bounds)[2])
{
	bool any = false;
	int start = 0;
	for (int j = 0; j < p->columns && !any; j++)
		any = column_hides(p, j);
	if (!any)
		return false;
	any = false;
	struct laid laid = { p, bounds, mem_new(4 * (size_t)p->rows * (size_t)p->columns, sizeof(float)), taken };
	while (start < p->columns && column_hides(p, start))
		start++;
	for (int j = 0; j < p->columns; j++) {
		int n = 0;
		while (n < p->columns - j && column_hides(p, start + j + n))
			n++;
		if (n)
			fill_run(&laid, start + j, n, variance);
		j += n;
	}
	settle(p, &laid);
	for (int k = 0; k < p->rows; k++)
		for (int j = 0; j < p->columns; j++)
			if (p->full[k] == k && *polar_kind(p, k, j) == POLAR_HIDDEN && laid.sum[4 * ((long)k * p->columns + j) + 3] > 0) {
				*polar_kind(p, k, j) = POLAR_SEEN;
				any = true;
			}
	free(laid.sum);
	return any;
}

static void fill_sheet(struct polar *p)
{
	enum { PASSES = 4 };  // what a strip's source lacked is filled from what is filled by then
	double variance = variance_of(p);
	float bounds[3][2];
	bounds_of(bounds, p);
	int *taken = mem_new((size_t)p->columns, sizeof *taken);
	for (int i = 0; i < PASSES && fill_pass(p, taken, variance, bounds); i++)
		;
	free(taken);
	mirror_rims(p);
}

static float fade(float weight)
{
	float x = fminf(fmaxf((weight - 0.15f) / 0.45f, 0), 1);
	return x * x * (3 - 2 * x);
}

void unrefract_fill(struct unrefract_texture *texture, const struct eye *eye)
{
	struct polar p = polar_new(texture, eye->limbus_radius);
	int size = texture->rgbw.width;
	double mm = 2 * texture->extent / size;
	if (p.full[0] >= 0) {
		fill_sheet(&p);
#pragma omp parallel for schedule(dynamic, 8)
		for (int row = 0; row < size; row++)
			for (int col = 0; col < size; col++) {
				float *px = image_at(&texture->rgbw, col, row), rgb[3], w = fade(px[3]);
				if (w < 1 && polar_colour(rgb, &p, (col + 0.5) * mm - texture->extent, (row + 0.5) * mm - texture->extent))
					for (int c = 0; c < 3; c++)
						px[c] = w * px[c] + (1 - w) * rgb[c];
			}
	}
	polar_free(&p);
}
