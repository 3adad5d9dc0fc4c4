#include "track/lid/lid_track.h"

#include <math.h>
#include <string.h>

// Frames a second that are learnt from: appearance is averaged over some seconds at any frame rate.
static const double LEARNT_FPS = 60;

void lid_track_start(struct lid_track *lids, int columns, int points, double wet_mm, double fps)
{
	memset(lids, 0, sizeof *lids);
	lids->columns = columns;
	lids->wet_mm = wet_mm;
	lids->every = fps > 1.5 * LEARNT_FPS ? (int)lround(fps / LEARNT_FPS) : 1;
	lids->points = points < LID_TRACK_POINTS ? points : LID_TRACK_POINTS;
}

/* A lens between the corners: the shape of an open eye, upper and lower height as shares of the corners' distance. */
static void lens(struct lid_curves *curves, const struct lid_chart *chart, double upper, double lower)
{
	double a = lid_chart_corner(chart, 0), b = lid_chart_corner(chart, 1), row = hypot(chart->dv[0], chart->dv[1]);
	for (int i = 0; i < chart->cols; i++) {
		double t = (i - a) / (b - a), bow = t > 0 && t < 1 ? pow(4 * t * (1 - t), 0.65) : 0;
		curves->row[0][i] = LID_ROWS / 2 - bow * upper * chart->width / row;
		curves->row[1][i] = LID_ROWS / 2 + bow * lower * chart->width / row;
		if (bow == 0)
			curves->row[1][i] = curves->row[0][i];
	}
}

static struct lid_path_conf path_conf(const struct lid_track *lids, const struct lid_look *look, double upper,
                                      double lower)
{
	const struct lid_chart *chart = &lids->chart;
	double rows = chart->width / hypot(chart->dv[0], chart->dv[1]);
	struct lid_path_conf conf = { .sigma = { upper * rows, lower * rows }, .certain = 0.6, .bend = 1, .edge = 10,
		.cross = 3, .strip = 10 };
	conf.columns[0] = (int)ceil(lids->at[0][0]);
	conf.columns[1] = (int)floor(lids->at[1][0]);
	lid_chart_of(&conf.iris[0], &conf.iris[1], chart, look->iris);
	conf.iris[2] = look->iris_px / hypot(chart->du[0], chart->du[1]);
	conf.iris[3] = look->iris_px / hypot(chart->dv[0], chart->dv[1]);
	return conf;
}

static struct lid_iris iris_on(const struct lid_chart *chart, const struct lid_look *look)
{
	struct lid_iris iris;
	lid_chart_of(&iris.col, &iris.row, chart, look->iris);
	iris.cols = look->iris_px / hypot(chart->du[0], chart->du[1]);
	iris.rows = look->iris_px / hypot(chart->dv[0], chart->dv[1]);
	return iris;
}

/* First frame: histograms of cells that are surely eye (inside a lens too small, the iris) and surely lid (outside one too
 * large); find() then alternates between lids from colours and colours from lids. */
static void learn(struct lid_track *lids, const struct lid_look *look)
{
	const struct lid_chart *chart = &lids->chart;
	struct lid_curves small, large, usual;
	lens(&usual, chart, 0.22, 0.13);
	lens(&small, chart, 0.10, 0.06);
	lens(&large, chart, 0.36, 0.22);
	double col, row, high = look->iris_px / hypot(chart->dv[0], chart->dv[1]);
	lid_chart_of(&col, &row, chart, look->iris);
	memset(&lids->colour, 0, sizeof lids->colour);
	for (int i = 0; i < chart->cols; i++) {
		bool iris = fabs(i - col) * hypot(chart->du[0], chart->du[1]) < 0.8 * look->iris_px;
		small.row[0][i] = fmin(small.row[0][i], iris ? row - 0.3 * high : LID_ROWS);
		small.row[1][i] = fmax(small.row[1][i], iris ? row + 0.5 * high : 0);
	}
	struct lid_curves none = large;
	struct lid_iris iris = iris_on(chart, look);
	lid_colour_learn(&lids->colour, chart, small.row[0], small.row[1], &iris, (double[2]){ 0, 0 }, -1, 1);
	for (int i = 0; i < chart->cols; i++)
		if (none.row[1][i] <= none.row[0][i])
			none.row[0][i] = none.row[1][i] = LID_ROWS / 2;
	// Cells between the two are left out.
	lid_colour_learn(&lids->colour, chart, none.row[0], none.row[1], &iris, (double[2]){ 0, LID_ROWS }, LID_ROWS, 1);
	lids->curves = usual;
}

/* Refines the lines on the lids to a fraction of a row: by their strips, in the first frame by edges. */
static void settle(struct lid_found *found, struct lid_track *lids, const struct lid_picture *picture, bool fresh)
{
	struct lid_chart *chart = &lids->chart;
	int first, last;
	if (!lid_opening(&first, &last, &lids->curves, chart->cols, 2.5))
		return;
	struct lid_margin_conf conf = { .reach = fmax(3, 0.02 * chart->width), .wet = 0, .bend = 3 };
	for (int k = 0; k < 2; k++) {
		if (fresh) {
			found->clear[k] = lid_margin_settle(&lids->curves, k, first, last, chart, picture, &conf);
		} else {
			found->misfit[k] = lid_path_refine(lids->curves.row[k], &lids->match, k, first, last, 0.3);
			found->clear[k] = fmax(0, 1 - found->misfit[k] / LID_STRIP_WORST);
		}
	}
	// Columns outside the opening: both margins continue, shut.
	for (int i = 0; i < chart->cols; i++) {
		int e = i < first ? first : i > last ? last : -1;
		double mid = e < 0 ? 0 : 0.5 * (lids->curves.row[0][e] + lids->curves.row[1][e]);
		if (e >= 0)
			lids->curves.row[0][i] = lids->curves.row[1][i] = mid;
	}
}

/* Updates the offset from lines to margins, from the strips so far; wet: prior, rows. */
static void place(struct lid_track *lids, double wet)
{
	int n = lids->chart.cols;
	for (int k = 0; k < 2; k++) {
		double edge[LID_COLS_MAX], w[LID_COLS_MAX];
		lid_strip_edge(edge, w, &lids->strip[k], n);
		double sure[LID_COLS_MAX];
		for (int i = 0; i < n; i++)
			sure[i] = w[i];
		for (int round = 0; round < 4; round++) {
			double v[LID_COLS_MAX], y[LID_COLS_MAX];
			for (int i = 0; i < n; i++) {
				double u = round ? (edge[i] - lids->offset[k][i]) / 4 : 0;
				w[i] = sure[i] * (fabs(u) < 1 ? (1 - u * u) * (1 - u * u) : 0);
				v[i] = w[i] + 0.05;
				y[i] = (w[i] * edge[i] + 0.05 * wet) / v[i];
			}
			lid_smooth(lids->offset[k], n, y, v, 3);
		}
	}
}

static void margins(struct lid_found *found, struct lid_track *lids)
{
	int first, last, n = lids->chart.cols;
	bool any = lid_opening(&first, &last, &lids->curves, n, 1.5);
	first = any ? (int)fmax(first, ceil(lids->at[0][0])) : 0;
	last = any ? (int)fmin(last, floor(lids->at[1][0])) : -1;
	lids->margins = lids->curves;
	for (int i = 0; i < n; i++)
		if (i < first || i > last)
			lids->margins.row[0][i] = lids->margins.row[1][i] = 0.5 * (lids->curves.row[0][i] + lids->curves.row[1][i]);
	for (int k = 0; any && k < 2; k++)
		for (int i = first; i <= last; i++)
			lids->margins.row[k][i] += (k ? 1 : -1) * lids->offset[k][i];
	found->open = any && lid_opening(&found->first, &found->last, &lids->margins, n, 1.5);
}

static void report(struct lid_found *found, const struct lid_track *lids)
{
	const struct lid_chart *chart = &lids->chart;
	double row = hypot(chart->dv[0], chart->dv[1]), col = hypot(chart->du[0], chart->du[1]), c[2][2];
	for (int k = 0; k < 4; k++)
		c[k / 2][k % 2] = lids->at[k / 2][k % 2];
	found->gap = found->area = 0;
	for (int i = found->first; i <= found->last; i++) {
		double gap = (lids->margins.row[1][i] - lids->margins.row[0][i]) * row;
		found->area += gap * col;
		found->gap = fmax(found->gap, gap);
	}
	for (int k = 0; k < 2; k++) {
		lid_points(found->p[k], lids->points, &lids->margins, k, found->first, found->last, c, chart);
		lid_chart_px(found->corner[k], chart, c[k][0], c[k][1]);
	}
}

static void ask_strips(struct lid_track *lids, const struct lid_curves *expect)
{
	struct lid_match *match = &lids->match;
	int reach = LID_ROWS / 4;
	match->known = true;
	for (int k = 0; k < 2; k++) {
		double lo = LID_ROWS, hi = 0;
		for (int i = 0; i < lids->chart.cols; i++) {
			lo = fmin(lo, expect->row[k][i]);
			hi = fmax(hi, expect->row[k][i]);
		}
		match->first[k] = (int)fmax(0, lo - reach);
		match->last[k] = (int)fmin(LID_ROWS, hi + reach);
		lid_strip_cost(match->cost[k], &lids->strip[k], &lids->chart, match->first[k], match->last[k]);
	}
}

/* Log odds of eye against lid for every cell of the chart, by the evidence. */
static void ask_evidence(float odds[LID_ROWS][LID_COLS_MAX], const struct evidence *e, const struct lid_chart *chart)
{
	const float least = 0.02F;
	for (int j = 0; j < LID_ROWS; j++)
		for (int i = 0; i < chart->cols; i++) {
			double p[2];
			lid_chart_px(p, chart, i, j);
			const float eye = evidence_eye_at(e, p[0], p[1]);
			odds[j][i] = fmaxf(-LID_SURE, fminf(LID_SURE, logf((eye + least) / (1 - eye + least))));
		}
}

static void find(struct lid_found *found, struct lid_track *lids, const struct lid_look *look, bool fresh)
{
	float odds[LID_ROWS][LID_COLS_MAX];
	struct lid_curves expect = lids->curves;
	double rows = lids->chart.width / hypot(lids->chart.dv[0], lids->chart.dv[1]);
	struct lid_path_conf conf = path_conf(lids, look, 0.12, fresh ? 0.08 : 0.04);
	struct lid_iris iris = iris_on(&lids->chart, look);
	lids->match.known = false;
	if (!fresh)
		ask_strips(lids, &expect);
	for (int k = 0; k < (fresh ? 4 : 1); k++) {
		if (!look->evidence && (fresh || lids->frames % (4 * lids->every) == 0))
			lid_colour_settle(&lids->colour);
		if (look->evidence)
			ask_evidence(odds, look->evidence, &lids->chart);
		else
			lid_colour_ask(odds, &lids->colour, &lids->chart, &iris);
		found->sense = lid_path(&lids->curves, &lids->chart, odds, &lids->match, &expect, &conf);
		if (fresh)
			lid_colour_learn(&lids->colour, &lids->chart, lids->curves.row[0], lids->curves.row[1], &iris,
			                 (double[2]){ 1, 1 }, 0.12 * rows, 0.3);
	}
}

bool lid_track_push(struct lid_found *found, struct lid_track *lids, const struct lid_picture *picture,
                    const struct lid_look *look)
{
	bool fresh = !lids->known;
	*found = (struct lid_found){ 0 };
	if (!lid_chart_lay(&lids->chart, lids->columns, look->inner, look->outer, look->down))
		return false;
	if (fresh && !(look->iris_px > 3))
		return false;
	lid_chart_fill(&lids->chart, picture->rgb, picture->stride, picture->width, picture->height);
	double high = hypot(lids->chart.dv[0], lids->chart.dv[1]), rows = lids->chart.width / high;
	if (fresh) {
		learn(lids, look);
		lids->strip[1].lower = 1;
	}
	for (int k = 0; k < 2; k++) {
		double shift[2];
		lid_corner_find(shift, &lids->corner[k], k, &lids->chart, picture);
		lids->at[k][0] = lid_chart_corner(&lids->chart, k) + shift[0];
		lids->at[k][1] = LID_ROWS / 2 + shift[1];
	}
	find(found, lids, look, fresh);
	lids->known = true;
	settle(found, lids, picture, fresh);
	if (lids->frames % (8 * lids->every) == 0)
		place(lids, lids->wet = lids->wet_mm * look->mm / high);
	margins(found, lids);
	lids->frames++;
	if (!found->open)
		return true;
	report(found, lids);
	struct lid_iris iris = iris_on(&lids->chart, look);
	if (found->sense > 1 && lids->frames % (2 * lids->every) == 0)
		lid_colour_learn(&lids->colour, &lids->chart, lids->margins.row[0], lids->margins.row[1], &iris, (double[2]){ 1, 3 },
		                 0.12 * rows, 0.97);
	for (int k = 0; k < 2 && (lids->frames - 1) % lids->every == 0; k++)
		if (fresh || found->misfit[k] < 1.5)
			lid_strip_learn(&lids->strip[k], &lids->chart, lids->curves.row[k], found->first, found->last);
	return true;
}

void lid_track_keep(struct lid_kept *kept, const struct lid_track *lids)
{
	const struct lid_chart *chart = &lids->chart;
	for (int c = 0; c < 2; c++) {
		kept->origin[c] = chart->origin[c];
		kept->du[c] = chart->du[c];
		kept->dv[c] = chart->dv[c];
		for (int k = 0; k < 2; k++)
			kept->at[c][k] = (float)lids->at[c][k];
		for (int i = 0; i < LID_COLS_MAX; i++)
			kept->row[c][i] = i < chart->cols ? (float)lids->curves.row[c][i] : 0;
	}
	kept->width = chart->width;
}

void lid_track_end(struct lid_track *lids)
{
	if (lids->known)
		place(lids, lids->wet);
}

void lid_track_again(struct lid_found *found, struct lid_track *lids, const struct lid_kept *kept)
{
	struct lid_chart *chart = &lids->chart;
	for (int c = 0; c < 2; c++) {
		chart->origin[c] = kept->origin[c];
		chart->du[c] = kept->du[c];
		chart->dv[c] = kept->dv[c];
		for (int k = 0; k < 2; k++)
			lids->at[c][k] = kept->at[c][k];
		for (int i = 0; i < chart->cols; i++)
			lids->curves.row[c][i] = kept->row[c][i];
	}
	chart->width = kept->width;
	margins(found, lids);
	if (found->open)
		report(found, lids);
}

double lid_track_rows(const struct lid_track *lids, double px)
{
	return px / hypot(lids->chart.dv[0], lids->chart.dv[1]);
}

bool lid_track_inside(const struct lid_track *lids, const double px[2], double rows)
{
	double col, row;
	lid_chart_of(&col, &row, &lids->chart, px);
	int i = (int)lround(col);
	if (!lids->known || i < 0 || i >= lids->chart.cols)
		return false;
	return row - lids->margins.row[0][i] > rows && lids->margins.row[1][i] - row > rows;
}
