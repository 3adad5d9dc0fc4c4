#include "skin/lid_track.h"

#include <math.h>
#include <string.h>

void lid_track_start(struct lid_track *lids, int columns, int points)
{
	memset(lids, 0, sizeof *lids);
	lids->columns = columns;
	lids->points = points < LID_TRACK_POINTS ? points : LID_TRACK_POINTS;
}

/* A lens between the corners: the shape of an open eye, upper and lower height as shares of the corners' distance. */
static void lens(struct lid_curves *curves, const struct lid_chart *chart, double upper, double lower)
{
	double a = lid_chart_corner(chart, 0), b = lid_chart_corner(chart, 1), row = hypot(chart->dv[0], chart->dv[1]);
	for (int i = 0; i < chart->cols; i++) {
		double t = (i - a) / (b - a), bow = t > 0 && t < 1 ? pow(4 * t * (1 - t), 0.8) : 0;
		curves->row[0][i] = LID_ROWS / 2 - bow * upper * chart->width / row;
		curves->row[1][i] = LID_ROWS / 2 + bow * lower * chart->width / row;
		if (bow == 0)
			curves->row[1][i] = curves->row[0][i];
	}
}

static struct lid_path_conf path_conf(const struct lid_chart *chart, double upper, double lower)
{
	double rows = chart->width / hypot(chart->dv[0], chart->dv[1]);
	return (struct lid_path_conf){ .sigma = { upper * rows, lower * rows }, .certain = 0.3, .bend = 0.4, .edge = 3 };
}

/* The first frame: colours of what is surely eye (a lens much too small, the iris) and surely lid (outside one too large),
 * then in turns lids from colours and colours from lids. */
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
	lid_colour_learn(&lids->colour, chart, small.row[0], small.row[1], (double[2]){ 0, 0 }, -1, 1);
	for (int i = 0; i < chart->cols; i++)
		if (none.row[1][i] <= none.row[0][i])
			none.row[0][i] = none.row[1][i] = LID_ROWS / 2;
	// What is between the two is not known yet.
	lid_colour_learn(&lids->colour, chart, none.row[0], none.row[1], (double[2]){ 0, LID_ROWS }, LID_ROWS, 1);
	lids->curves = usual;
}

static void settle(struct lid_found *found, struct lid_track *lids, const struct lid_picture *picture,
                   const struct lid_look *look)
{
	struct lid_chart *chart = &lids->chart;
	found->open = lid_opening(&found->first, &found->last, &lids->curves, chart->cols, 2.5);
	if (!found->open)
		return;
	struct lid_margin_conf conf = { .reach = fmax(4, 0.05 * chart->width), .wet = 0.1 * look->mm, .bend = 3 };
	for (int k = 0; k < 2; k++)
		found->clear[k] = lid_margin_settle(&lids->curves, k, found->first, found->last, chart, picture, &conf);
	// Columns outside the opening: both margins run on, shut.
	for (int i = 0; i < chart->cols; i++) {
		int e = i < found->first ? found->first : i > found->last ? found->last : -1;
		double mid = e < 0 ? 0 : 0.5 * (lids->curves.row[0][e] + lids->curves.row[1][e]);
		if (e >= 0)
			lids->curves.row[0][i] = lids->curves.row[1][i] = mid;
	}
}

/* Where both margins would meet, a little beyond the last open column. */
static void corner(double out[2], const struct lid_curves *curves, int end, int step)
{
	double gap = curves->row[1][end] - curves->row[0][end];
	double next = curves->row[1][end + 3 * step] - curves->row[0][end + 3 * step], grow = fmax(0.3, (next - gap) / 3);
	out[0] = end - step * fmin(3, fmax(0.3, 0.7 * gap / grow));
	out[1] = 0.5 * (curves->row[0][end] + curves->row[1][end]);
}

static void report(struct lid_found *found, const struct lid_track *lids)
{
	const struct lid_chart *chart = &lids->chart;
	double row = hypot(chart->dv[0], chart->dv[1]), col = hypot(chart->du[0], chart->du[1]), c[2][2];
	corner(c[0], &lids->curves, found->first, 1);
	corner(c[1], &lids->curves, found->last, -1);
	found->gap = found->area = 0;
	for (int i = found->first; i <= found->last; i++) {
		double gap = (lids->curves.row[1][i] - lids->curves.row[0][i]) * row;
		found->area += gap * col;
		found->gap = fmax(found->gap, gap);
	}
	for (int k = 0; k < 2; k++) {
		lid_points(found->p[k], lids->points, &lids->curves, k, found->first, found->last, c, chart);
		lid_chart_px(found->corner[k], chart, c[k][0], c[k][1]);
	}
}

bool lid_track_push(struct lid_found *found, struct lid_track *lids, const struct lid_picture *picture,
                    const struct lid_look *look)
{
	float odds[LID_ROWS][LID_COLS_MAX];
	*found = (struct lid_found){ 0 };
	if (!lid_chart_lay(&lids->chart, lids->columns, look->inner, look->outer, look->down))
		return false;
	if (!lids->known && !(look->iris_px > 3))
		return false;
	lid_chart_fill(&lids->chart, picture->rgb, picture->stride, picture->width, picture->height);
	int rounds = lids->known ? 1 : 4;
	if (!lids->known)
		learn(lids, look);
	struct lid_curves expect = lids->curves;
	for (int k = 0; k < rounds; k++) {
		struct lid_path_conf conf = lids->known ? path_conf(&lids->chart, 0.12, 0.04) : path_conf(&lids->chart, 0.12, 0.08);
		if (!lids->known || lids->frames % 4 == 0)
			lid_colour_settle(&lids->colour);
		lid_colour_ask(odds, &lids->colour, &lids->chart);
		found->sense = lid_path(&lids->curves, &lids->chart, odds, &expect, &conf);
		double rows = lids->chart.width / hypot(lids->chart.dv[0], lids->chart.dv[1]);
		if (!lids->known)
			lid_colour_learn(&lids->colour, &lids->chart, lids->curves.row[0], lids->curves.row[1],
			                 (double[2]){ 1, 1 }, 0.12 * rows, 0.3);
	}
	lids->known = true;
	lids->frames++;
	settle(found, lids, picture, look);
	if (found->open) {
		report(found, lids);
		double rows = lids->chart.width / hypot(lids->chart.dv[0], lids->chart.dv[1]);
		if (found->sense > 1 && lids->frames % 2 == 0)
			lid_colour_learn(&lids->colour, &lids->chart, lids->curves.row[0], lids->curves.row[1],
			                 (double[2]){ 1.5, 1.5 }, 0.12 * rows, 0.97);
	}
	return true;
}

bool lid_track_inside(const struct lid_track *lids, const double px[2], double inside)
{
	double col, row, high = hypot(lids->chart.dv[0], lids->chart.dv[1]);
	lid_chart_of(&col, &row, &lids->chart, px);
	int i = (int)lround(col);
	if (!lids->known || i < 0 || i >= lids->chart.cols)
		return false;
	return row - lids->curves.row[0][i] > inside / high && lids->curves.row[1][i] - row > inside / high;
}
