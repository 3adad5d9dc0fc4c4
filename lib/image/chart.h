/* chart: curves as an SVG picture: several panels, each with its own axes. Plain SVG 1.1 without scripts, in the reader's
 * sans-serif font, so that it can be embedded in a page.
 */
#ifndef IMAGE_CHART_H
#define IMAGE_CHART_H
#include "base/err.h"

struct chart_series {
	const char *name;     // in the legend; null: not there
	const char *colour;   // "#1f77b4"
	const char *dash;     // "6 4", or null: a full line
	int n;
	const double *x, *y;  // [n]; NAN interrupts the line
	const double *sigma;  // [n] band y - sigma .. y + sigma, or null
	bool dots, no_line;   // a dot at each point; no line between them
};

struct chart_panel {
	const char *title, *x_label, *y_label;
	int n;
	const struct chart_series *series;
	double y_low, y_high; // both NAN: from the data
};

/* Writes n panels of width x height px, `columns` of them in a row. made_by: JSON text for the metadata element, or null.
 * False, err set, when the file cannot be written. */
bool chart_save(const char *path, int columns, int width, int height, int n, const struct chart_panel panels[],
                const char *made_by, struct err *err);

#endif
