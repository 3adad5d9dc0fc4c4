/* chart: curves as an SVG picture for people to look at: several panels, each with its own axes. Plain SVG 1.1, no script,
 * no font but the reader's sans-serif: it can be embedded in a page. */
#ifndef IMAGE_CHART_H
#define IMAGE_CHART_H
#include "base/err.h"

struct chart_series {
	const char *name;     // in the legend; null: not there
	const char *colour;   // "#1f77b4"
	const char *dash;     // "6 4", or null: a full line
	int n;
	const double *x, *y;  // NAN interrupts the line
	const double *sigma;  // band y - sigma .. y + sigma, or null
	bool dots, no_line;   // a dot at each point; nothing between them
};

struct chart_panel {
	const char *title, *x_label, *y_label;
	int n;
	const struct chart_series *series;
	double y_low, y_high; // both NAN: from the data
};

/* Panels of width x height px in `columns` columns. made_by: JSON text for the metadata element, or null. */
bool chart_save(const char *path, int columns, int width, int height, int n, const struct chart_panel panels[],
                const char *made_by, struct err *err);

#endif
