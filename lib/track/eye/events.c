#include "track/eye/events.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"
#include "track/eye/eye_track_impl.h"

// Seconds: a blink lasts no longer (table 3.1: closing, closed and opening, long tails cut), and within so many on both
// sides of it the eye was open.
static const double BLINK_LONGEST = 0.8, AROUND = 0.5;
// Share of the opening below which the eye counts as closed, and share of a blink's depth at which it begins and ends.
static const double CLOSED = 0.15, ONSET = 0.15;
// Least closure of a wink.
static const double WINK = 0.5;

static struct eye_event *new_event(struct eye_clip *clip, int kind, int side)
{
	clip->event = mem_grow(clip->event, (size_t)clip->events + 1, sizeof *clip->event);
	struct eye_event *event = &clip->event[clip->events++];
	*event = (struct eye_event){ .side = side };
	event->kind = kind;
	return event;
}

/* Height of the middle of the lower lid above the line between the corners, mm. */
static double lower_height(const struct eye_record *record, int points)
{
	const struct lid_found *found = &record->found;
	double dx = found->corner[1][0] - found->corner[0][0], dy = found->corner[1][1] - found->corner[0][1];
	double low[2], up[2];
	for (int k = 0; k < 2; k++) {
		low[k] = found->p[1][points / 2][k] - found->corner[0][k];
		up[k] = found->p[0][points / 2][k] - found->p[1][points / 2][k];
	}
	double away = dx * low[1] - dy * low[0], side = dx * up[1] - dy * up[0] < 0 ? -1 : 1;
	return side * away / hypot(dx, dy) / record->mm;
}

/* Time series: height of the opening, mm, 0 shut, NAN not measured; of the lower lid, held while shut; vertical gaze,
 * interpolated. */
static void series(double gap[], double lower[], double v[], const struct eye_side *eye)
{
	long n = eye->frames, last = -1;
	double held = 0;
	for (long i = 0; i < n; i++) {
		const struct eye_record *record = &eye->record[i];
		gap[i] = !record->measured ? NAN : record->open ? record->found.gap / record->mm : 0;
		if (record->measured && record->open)
			held = lower_height(record, eye->lids.points);
		lower[i] = held;
		v[i] = eye->state[i].gaze[1];
		if (!isfinite(v[i]))
			continue;
		for (long k = last + 1; k < i; k++) {
			double f = last < 0 ? 1 : (double)(k - last) / (i - last);
			v[k] = last < 0 ? v[i] : (1 - f) * v[last] + f * v[i];
		}
		last = i;
	}
	for (long k = last + 1; k < n; k++)
		v[k] = last < 0 ? 0 : v[last];
}

/* Usual opening as a function of vertical gaze, gap = line[0] + line[1] v: least squares with Tukey weights on the side of frames
 * that are shut further. Returns false with too few frames. */
static bool usual(double line[2], long n, const double gap[], const double v[])
{
	line[0] = line[1] = 0;
	double scale = 1e9;
	for (int round = 0; round < 8; round++) {
		double a[2][2] = { { 1e-9, 0 }, { 0, 1e-3 } }, b[2] = { 0 }, square = 0, weight = 0;
		for (long i = 0; i < n; i++) {
			double r = gap[i] - line[0] - line[1] * v[i], u = fmin(0, r) / (3 * scale);
			double w = fabs(u) < 1 ? (1 - u * u) * (1 - u * u) : 0;
			if (!isfinite(gap[i]) || gap[i] <= 0)
				continue;
			a[0][0] += w, a[0][1] += w * v[i], a[1][1] += w * v[i] * v[i];
			b[0] += w * gap[i], b[1] += w * v[i] * gap[i];
			square += w * r * r;
			weight += w;
		}
		double det = a[0][0] * a[1][1] - a[0][1] * a[0][1];
		if (!(weight >= 3) || !(det > 0))
			return false;
		line[0] = (a[1][1] * b[0] - a[0][1] * b[1]) / det;
		line[1] = (a[0][0] * b[1] - a[0][1] * b[0]) / det;
		scale = round ? fmax(0.25, sqrt(square / weight)) : 2;
	}
	return line[0] > 0.5;
}

static double around(const double open[], long n, long i, long half)
{
	double part[512];
	int m = 0;
	long step = 1 + 2 * half / 500;
	for (long k = i - half; k <= i + half; k += step)
		if (k >= 0 && k < n && isfinite(open[k]))
			part[m++] = open[k];
	return m ? stats_quantile(m, part, 0.7) : NAN;
}

static void mark(struct eye_side *eye, const struct eye_event *event, const double open[], double base)
{
	for (int i = event->first; i <= event->last; i++) {
		enum blink_state what = i < event->peak ? BLINK_CLOSING : BLINK_OPENING;
		if (open[i] < CLOSED * base || i == event->peak)
			what = BLINK_CLOSED;
		eye->state[i].blink = what;
	}
}

static void blinks(struct eye_clip *clip, struct eye_side *eye, int side, const double open[],
                   const double lower[], double usual_gap)
{
	long n = eye->frames, half = (long)ceil(AROUND * eye->scene->fps), longest = (long)(BLINK_LONGEST * eye->scene->fps);
	for (long i = 0; i < n; i++) {
		double base = around(open, n, i, half);
		if (!(base - open[i] > eye->conf->blink_depth * base))
			continue;
		long low = i, last = i;
		while (last + 1 < n && !(base - open[last + 1] < eye->conf->blink_depth * base)) {
			last++;
			low = open[last] < open[low] ? last : low;
		}
		double depth = base - open[low];
		long first = i;
		while (first > 0 && base - open[first - 1] > ONSET * depth && open[first - 1] >= open[first] && i - first < longest)
			first--;
		long end = last;
		while (end + 1 < n && base - open[end + 1] > ONSET * depth && open[end + 1] >= open[end] && end - last < longest)
			end++;
		// In a blink the upper lid moves; a squint raises the lower one.
		bool falls = lower[low] - lower[first] < 0.5 * depth * usual_gap;
		// what an end of the clip cuts off may be a look down, unless the eye shuts
		bool whole = (i > 0 && last + 1 < n) || open[low] < CLOSED * base;
		if (last - i <= longest && falls && whole) {
			struct eye_event *event = new_event(clip, EVENT_BLINK, side);
			event->first = (int)first;
			event->last = (int)end;
			event->peak = (int)low;
			event->amplitude = depth / base;
			mark(eye, event, open, base);
		}
		i = end;
	}
}

/* Angle between two directions of gaze. */
static double angle(const double a[3], const double b[3])
{
	double c = sin(a[1]) * sin(b[1]) + cos(a[1]) * cos(b[1]) * cos(a[0] - b[0]);
	return acos(fmin(1, c));
}

/* Speed of gaze in frame f of a run from `first` on, radians/s; NAN where it is not known. A frame in which nothing seemed to have moved holds the last gaze:
 * within a run the speed goes over it. */
static double speed_of(const struct eye_state *s, long n, long first, long f)
{
	long a = f - 1, b = f;
	if (f > first && b + 1 < n && s[b].gaze[0] == s[a].gaze[0] && s[b].gaze[1] == s[a].gaze[1])
		b++;
	else if (f > first + 1 && s[a].gaze[0] == s[a - 1].gaze[0] && s[a].gaze[1] == s[a - 1].gaze[1])
		a--;
	const double dt = s[b].time - s[a].time;
	return !isfinite(s[a].gaze[0] + s[f].gaze[0] + s[b].gaze[0]) ? NAN : dt > 0 ? angle(s[b].gaze, s[a].gaze) / dt : 0;
}

static void saccades(struct eye_clip *clip, struct eye_side *eye, int side)
{
	double fast = eye->conf->saccade_speed * M_PI / 180, least = eye->conf->saccade_size * M_PI / 180;
	const struct eye_state *s = eye->state;
	for (long i = 1; i < eye->frames; i++) {
		double peak = 0;
		long last = i, at = i;
		while (last < eye->frames) {
			double speed = speed_of(s, eye->frames, i, last);
			if (!(speed > fast))
				break;
			if (speed > peak) {
				peak = speed;
				at = last;
			}
			last++;
		}
		if (last == i)
			continue;
		double size = angle(s[last - 1].gaze, s[i - 1].gaze);
		if (size >= least) {
			struct eye_event *event = new_event(clip, EVENT_SACCADE, side);
			event->first = (int)i - 1;
			event->last = (int)last - 1;
			event->peak = (int)at;
			event->amplitude = size;
			event->peak_speed = peak;
		}
		i = last;
	}
}

void eye_side_events(struct eye_clip *clip, struct eye_side *eye, int side)
{
	long n = eye->frames;
	double *gap = mem_array(3 * (size_t)n + 1, sizeof *gap), *v = gap + n, *lower = v + n, line[2];
	series(gap, lower, v, eye);
	if (usual(line, n, gap, v)) {
		for (long i = 0; i < n; i++) {
			gap[i] = fmin(1.5, gap[i] / fmax(0.3 * line[0], line[0] + line[1] * v[i]));
			eye->state[i].openness = fmin(1, gap[i]);
		}
		blinks(clip, eye, side, gap, lower, line[0]);
	}
	saccades(clip, eye, side);
	free(gap);
}

/* Marks the frames of an event as open. */
static void unmark(struct eye_side *eye, const struct eye_event *event)
{
	for (int i = event->first; i <= event->last; i++)
		eye->state[i].blink = BLINK_OPEN;
}

/* Whether the other eye blinks at the same time. */
static bool in_both(const struct eye_clip *clip, const struct eye_event *e)
{
	for (int k = 0; k < clip->events; k++) {
		const struct eye_event *o = &clip->event[k];
		if (o->kind == EVENT_BLINK && o->side != e->side && o->first <= e->last && o->last >= e->first)
			return true;
	}
	return false;
}

void eye_pair_blinks(struct eye_clip *clip, struct eye_side side[SIDES])
{
	int n = 0;
	bool *lone = mem_new((size_t)clip->events + 1, sizeof *lone);
	for (int i = 0; i < clip->events; i++) {
		const struct eye_event *e = &clip->event[i];
		lone[i] = e->kind == EVENT_BLINK && e->amplitude < WINK && clip->globe[!e->side].seen && side[!e->side].state[e->peak].openness > WINK && !in_both(clip, e);
	}
	for (int i = 0; i < clip->events; i++) {
		if (lone[i])
			unmark(&side[clip->event[i].side], &clip->event[i]);
		else
			clip->event[n++] = clip->event[i];
	}
	clip->events = n;
	free(lone);
}

/* Whether an event may stand though frames are forgotten. */
static bool stands(const struct eye_clip *clip, const struct eye_event *e, const bool *forgotten)
{
	for (int f = e->first; f <= e->last && e->kind == EVENT_SACCADE; f++)
		if (forgotten[f])
			return false;
	return e->kind == EVENT_SACCADE || !forgotten[e->peak] || in_both(clip, e);
}

void eye_clip_forget(struct eye_clip *clip, const bool *forgotten)
{
	int n = 0;
	bool *keep = mem_new((size_t)clip->events + 1, sizeof *keep);
	for (int i = 0; i < clip->events; i++)
		keep[i] = stands(clip, &clip->event[i], forgotten);
	for (int i = 0; i < clip->events; i++) {
		const struct eye_event *e = &clip->event[i];
		for (int f = e->first; f <= e->last && !keep[i] && e->kind == EVENT_BLINK; f++)
			clip->state[f][e->side].blink = BLINK_OPEN;
		if (keep[i])
			clip->event[n++] = *e;
	}
	clip->events = n;
	free(keep);
	for (long f = 0; f < clip->frames; f++)
		for (int e = 0; e < SIDES && forgotten[f]; e++) {
			struct eye_state *s = &clip->state[f][e];
			s->confidence = 0;
			for (int k = 0; k < 3; k++)
				s->gaze[k] = s->sigma[k] = NAN;
			for (int k = 0; k < LIDS * LID_POINTS_MAX * 2; k++)
				(&s->lid[0][0][0])[k] = NAN;
		}
}
