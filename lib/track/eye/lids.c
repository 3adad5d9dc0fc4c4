/* Lids re-estimated when the whole clip has been seen. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "track/eye/eye_track_impl.h"

/* Margins by the strips as learnt over the whole clip. */
static void again(struct eye_side *eye)
{
	lid_track_end(&eye->lids);
	for (long i = 0; i < eye->frames; i++) {
		struct eye_record *record = &eye->record[i];
		if (!record->measured)
			continue;
		lid_track_again(&record->found, &eye->lids, &eye->kept[i]);
		record->open = record->found.open;
		if (record->open)
			eye_fill_lids(&eye->state[i], &record->found, eye->lids.points);
	}
}

/* Input of lid_fine_settle(): the upper margin found so far, less the tear meniscus. */
static void to_fine(struct lid_fine_frame *f, const struct lid_fine *look, const struct eye_state *state, const double iris[3], double wet_mm)
{
	struct line margin = { .n = state->lid_points };
	*f = (struct lid_fine_frame){ .look = look, .iris = { iris[0], iris[1], iris[2] } };
	memcpy(margin.p, state->lid[LID_UPPER], (size_t)margin.n * sizeof *margin.p);
	for (int k = 0; k < FINE_COLS; k++) {
		double p[2] = { (double)look->p[k][0], (double)look->p[k][1] }, q[2];
		line_nearest(q, &margin, p);
		f->expect[k] = (q[0] - p[0]) * (double)look->out[k][0] + (q[1] - p[1]) * (double)look->out[k][1] - wet_mm * (double)look->mm;
	}
}

static void from_fine(struct eye_state *state, const struct lid_fine_frame *f, double wet_mm)
{
	const struct lid_fine *look = f->look;
	struct line margin = { 0 };
	line_add(&margin, state->lid[LID_UPPER][0]);
	for (int k = 0; k < FINE_COLS; k++) {
		double off = f->end[k] + wet_mm * (double)look->mm;
		line_add(&margin, (double[2]){ (double)look->p[k][0] + off * (double)look->out[k][0], (double)look->p[k][1] + off * (double)look->out[k][1] });
	}
	line_add(&margin, state->lid[LID_UPPER][state->lid_points - 1]);
	line_spread(state->lid[LID_UPPER], state->lid_points, &margin);
}

/* Refines the upper margin: the visible end of the eye, plus the tear meniscus. (Lower margins are not shaded by lashes: the
 * strips locate their edge well enough.) */
static void refine(struct eye_side *eye)
{
	struct lid_fine_frame *frame = bulk_grow(eye->scene->bulk, 0, (size_t)eye->frames + 1, sizeof *frame);
	long *index = mem_array((size_t)eye->frames + 1, sizeof *index), n = 0;
	const double *iris = 0;
	for (long i = 0; i < eye->frames; i++) {
		// where a lid hides the gaze the last limbus is used
		if (isfinite(eye->state[i].limbus[0]))
			iris = eye->state[i].limbus;
		if (!iris || !eye->fine[i].known || !eye->record[i].open)
			continue;
		to_fine(&frame[n], &eye->fine[i], &eye->state[i], iris, eye->conf->lid_wet);
		index[n++] = i;
	}
	lid_fine_settle(n, frame);
	for (long i = 0; i < n; i++)
		from_fine(&eye->state[index[i]], &frame[i], eye->conf->lid_wet);
	bulk_free(eye->scene->bulk, frame);
	free(index);
}

void eye_settle_lids(struct eye_side *eye)
{
	again(eye);
	refine(eye);
}
