#include "track/eye/outline.h"

#include <math.h>
#include <string.h>

#include "track/eye/told.h"

static const double HALF = 0.5;   // chance of eye at the edge of an opening
static const double HIGH = 1.9;   // radii of the iris that are looked at above and below its middle: as far as the evidence goes

/* The longest stretch of eye on a column through `at`, from..to along `down`, px. False: there is none that ends on both sides. */
static bool stretch(double ends[LIDS], const struct evidence *e, const double at[2], const double down[2], double reach)
{
	const double step = 0.5 * e->scale;
	double before = 1, from = NAN, longest = 0;
	for (double v = -reach; v <= reach; v += step) {
		const double p = (double)evidence_eye_at(e, at[0] + v * down[0], at[1] + v * down[1]);
		// a stretch that has begun before the first place has no upper end
		if (p >= HALF && before < HALF)
			from = v - step * (p - HALF) / (p - before);
		if (p < HALF && before >= HALF && isfinite(from)) {
			const double to = v - step * (HALF - p) / (before - p);
			if (to - from > longest) {
				longest = to - from;
				ends[LID_UPPER] = from;
				ends[LID_LOWER] = to;
			}
			from = NAN;
		}
		before = p;
	}
	return longest > 0;
}

bool eye_outline_of(struct eye_outline *out, const struct evidence *e, const double place[3], const double across[2], const double down[2], double least_area)
{
	struct eye_told told;
	double end[2];
	memset(out, 0, sizeof *out);
	if (!eye_told_of(&told, e, place, across) || told.area < least_area)
		return false;
	out->radius = (float)place[2];
	for (int k = 0; k < 2; k++)
		end[k] = (told.corner[k][0] - place[0]) * across[0] + (told.corner[k][1] - place[1]) * across[1];
	for (int i = 0; i < OUTLINE_COLUMNS; i++) {
		const double a = end[0] + (i + 0.5) / OUTLINE_COLUMNS * (end[1] - end[0]), at[2] = { place[0] + a * across[0], place[1] + a * across[1] };
		double v[LIDS];
		const bool any = stretch(v, e, at, down, HIGH * place[2]);
		for (int k = 0; k < LIDS; k++)
			for (int c = 0; c < 2; c++)
				out->p[k][i][c] = any ? (float)(at[c] + v[k] * down[c]) : NAN;
	}
	return true;
}

double eye_outline_apart(const struct eye_outline *o, int lid, const double p[2], const double out[2], double most)
{
	double best = NAN;
	for (int i = 0; i + 1 < OUTLINE_COLUMNS; i++) {
		// both ends of a piece about the line through p: along it, and off it
		double along[2], off[2];
		for (int k = 0; k < 2; k++) {
			const double d[2] = { (double)o->p[lid][i + k][0] - p[0], (double)o->p[lid][i + k][1] - p[1] };
			along[k] = d[0] * out[0] + d[1] * out[1];
			off[k] = d[0] * out[1] - d[1] * out[0];
		}
		if (!(off[0] * off[1] <= 0) || off[0] == off[1])
			continue;
		const double s = along[0] + (along[1] - along[0]) * off[0] / (off[0] - off[1]);
		if (fabs(s) <= most && !(fabs(s) >= fabs(best)))
			best = s;
	}
	return best;
}
