#include "rig/make/make.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "math/stats.h"
#include "math/vec.h"
#include "rig/make/make_impl.h"

static const struct rig_camera no_camera;
/* Of the skull map. A fine mesh has ledges at its lids' margins and corners: skin that came to lie where one was went with it, up to 2.6 mm before the margin. Chosen on the bundled clip's
 * character and skin.sh's two others. */
static const double smooth_mm = 0.65;

static void *fresh(int n, size_t size)
{
	return mem_new((size_t)n + 1, size);
}

static void allocate(struct rig *rig, const struct mesh *mesh)
{
	int n = rig->n = mesh->n_vertices;
	rig->n_faces = mesh->n_faces;
	rig->faces = fresh(mesh->n_faces, sizeof *rig->faces);
	rig->rest = fresh(n, sizeof *rig->rest);
	rig->home = fresh(n, sizeof *rig->home);
	rig->basis = fresh(n, sizeof *rig->basis);
	rig->fade = fresh(n, sizeof *rig->fade);
	rig->thickness = fresh(n, sizeof *rig->thickness);
	rig->gap = fresh(n, sizeof *rig->gap);
	rig->glue = fresh(n, sizeof *rig->glue);
	rig->part = fresh(n, sizeof *rig->part);
	rig->source = fresh(n, sizeof *rig->source);
	rig->side = fresh(n, sizeof *rig->side);
	memcpy(rig->faces, mesh->faces, (size_t)mesh->n_faces * sizeof *rig->faces);
	memcpy(rig->rest, mesh->vertices, (size_t)n * sizeof *rig->rest);
	rig->normal = mesh_normals(mesh);
}

static void take_camera(struct rig *rig, const struct rig_motion *m, const double subject_from_target[4][4])
{
	struct rig_camera *c = &rig->camera;
	double scale = vec_norm(subject_from_target[0]);
	*c = no_camera;
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 4; j++) {
			c->from_target[i][j] = j == 3 ? m->camera.cam_from_head[i][3] : 0;
			for (int k = 0; k < 3; k++)
				c->from_target[i][j] += m->camera.cam_from_head[i][k] * subject_from_target[k][j];
		}
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			rig->head_from_target[i][j] = subject_from_target[i][j] / scale;
	c->focal_px[0] = c->focal_px[1] = m->camera.focal_px;
	c->center_px[0] = m->camera.center_px[0];
	c->center_px[1] = m->camera.center_px[1];
	c->width = m->camera.width;
	c->height = m->camera.height;
}

/* Median distance, px, between where the model has tracked points at rest and where the registered mesh is seen. */
static double off_chart(const struct rig *rig, const struct rig_motion *m, const struct rig_character *ch, const int *row)
{
	double *d = fresh(rig->n, sizeof *d);
	int n = 0;
	for (int i = 0; i < rig->n; i++) {
		double px[2] = { 0 };
		for (int j = ch->b_start[i]; j < ch->b_start[i + 1]; j++)
			for (int c = 0; c < 2 && rig->source[i] == RIG_TRACKED; c++)
				px[c] += row[ch->b_column[j]] >= 0 ? ch->b_weight[j] * m->rest_px[row[ch->b_column[j]]][c] : 0;
		if (rig->source[i] == RIG_TRACKED && isfinite(px[0] + px[1]))
			d[n++] = hypot(px[0] - rig->home[i][0], px[1] - rig->home[i][1]);
	}
	double median = stats_median(n, d);
	free(d);
	return median;
}

/* Motion of the vertices whose barycentric neighbours were all tracked (eq. 3.4); the others are to be extrapolated. */
static void take_tracked(struct rig *rig, const struct rig_motion *m, const struct rig_character *ch, double min_confidence,
                         struct rig_report *report)
{
	int last = 0;
	for (int k = 0; k < m->n; k++)
		last = m->vertex[k] > last ? m->vertex[k] : last;
	for (int i = 0; i < ch->b_start[rig->n]; i++)
		last = ch->b_column[i] > last ? ch->b_column[i] : last;
	int *row = fresh(last + 1, sizeof *row);
	for (int i = 0; i <= last; i++)
		row[i] = -1;
	for (int k = 0; k < m->n; k++)
		row[m->vertex[k]] = k;
	for (int i = 0; i < rig->n; i++) {
		double sum = 0, all = 0, basis[RIG_BASIS] = { 0 };
		for (int j = ch->b_start[i]; j < ch->b_start[i + 1]; j++) {
			int k = row[ch->b_column[j]];
			all += ch->b_weight[j];
			sum += k >= 0 ? ch->b_weight[j] : 0;
			for (int c = 0; k >= 0 && c < RIG_BASIS; c++)
				basis[c] += ch->b_weight[j] * m->basis[k][c];
		}
		bool tracked = all > 0.999 && sum > 0.999 && (!ch->confidence || ch->confidence[i] >= min_confidence)
		               && rig->part[i] == RIG_SKIN;
		rig->source[i] = tracked ? RIG_TRACKED : RIG_EXTRAPOLATED;
		for (int c = 0; tracked && c < RIG_BASIS; c++)
			rig->basis[i][c] = (float)basis[c];
	}
	report->off_chart = off_chart(rig, m, ch, row);
	free(row);
}

/* Motion of the others, by B+ and fade (eq. 3.5). */
static void extrapolate(struct rig *rig)
{
	for (int i = 0; i < rig->n; i++) {
		if (rig->source[i] != RIG_EXTRAPOLATED)
			continue;
		float sum[RIG_BASIS] = { 0 };
		for (int j = rig->bplus.start[i]; j < rig->bplus.start[i + 1]; j++)
			for (int k = 0; k < RIG_BASIS; k++)
				sum[k] += rig->bplus.weight[j] * rig->basis[rig->bplus.column[j]][k];
		for (int k = 0; k < RIG_BASIS; k++)
			rig->basis[i][k] = rig_is_globe(rig->part[i]) ? 0 : rig->fade[i] * sum[k];
	}
}

/* Distance of every skin vertex from the nearer globe at rest (eq. 3.14). */
static void take_gaps(struct rig *rig, struct rig_report *report)
{
	double rest[3][3], gaze[3] = { 0 };
	rig_globe_rotation(rest, rig, gaze);
	for (int i = 0; i < rig->n; i++) {
		double d[2];
		for (int s = 0; s < 2; s++)
			d[s] = rig_globe_distance(rig, s, (const double(*)[3])rest, rig->rest[i]);
		rig->side[i] = d[1] < d[0];
		rig->gap[i] = (float)d[rig->side[i]];
		if (rig->part[i] == RIG_SKIN && rig->gap[i] < 0) {
			report->inside_at_rest++;
			report->deepest = fmax(report->deepest, -rig->gap[i]);
		}
	}
}

static void take_thickness(struct rig *rig, const struct rig_conf *conf)
{
	for (int i = 0; i < rig->n; i++) {
		double gap = fmax(rig->gap[i], conf->least), t = (gap - conf->glue[0]) / (conf->glue[1] - conf->glue[0]);
		t = fmin(fmax(t, 0), 1);
		// The paper keeps the distance of extrapolated skin only. Here tracked lids keep theirs, too: otherwise a raised lid
		// sinks into the socket behind its own margin.
		rig->glue[i] = rig_is_globe(rig->part[i]) ? 0 : fmaxf(rig->glue[i], (float)(1 - t * t * (3 - 2 * t)));
		rig->gap[i] = (float)gap;
		rig->thickness[i] = (float)fmin(gap, conf->thickness);
	}
}

static void count(struct rig_report *report, const struct rig *rig)
{
	for (int i = 0; i < rig->n; i++) {
		if (rig_is_globe(rig->part[i]))
			continue;
		report->tracked += rig->source[i] == RIG_TRACKED;
		report->extrapolated += rig->source[i] == RIG_EXTRAPOLATED && rig->fade[i] > 0;
		report->still += rig->fade[i] == 0;
	}
}

/* Pixels of the modelling camera in a millimetre of the face. */
static double rig_px_per_mm(const struct rig *rig, const struct rig_motion *m, const struct rig_character *ch)
{
	double sum = 0;
	int n = 0;
	for (int i = 0; i < rig->n; i++) {
		double px[2], cam[3];
		rig_project(px, cam, &m->camera, ch->registered[i]);
		if (rig->source[i] == RIG_TRACKED && cam[2] > 0) {
			sum += m->camera.focal_px / cam[2];
			n++;
		}
	}
	return n ? sum / n : 1;
}

bool rig_make(struct rig *rig, struct rig_report *report, const struct rig_motion *motion, const struct rig_character *ch,
              const struct rig_conf *conf, struct err *err)
{
	double center[2][3], radius, px_per_mm = 1;
	size_t row = (size_t)motion->n_inputs + 1;
	*rig = (struct rig){ .n_inputs = motion->n_inputs };
	*report = (struct rig_report){ 0 };
	rig->W = mem_new(RIG_COMPONENTS * row, sizeof *rig->W);
	memcpy(rig->W, motion->W, RIG_COMPONENTS * row * sizeof *rig->W);
	rig->known = motion->known;
	rig->own_low = motion->own_low;
	memcpy(rig->rest_e, motion->rest_e, sizeof rig->rest_e);
	memcpy(rig->rest_aperture, motion->rest_aperture, sizeof rig->rest_aperture);
	memcpy(rig->baseline, motion->baseline, sizeof rig->baseline);
	const size_t expressions = (size_t)(motion->n_inputs - SKIN_EYE_INPUTS);
	rig->expression = mem_new(expressions + 1, sizeof *rig->expression);
	if (expressions)
		memcpy(rig->expression, motion->expression, expressions * sizeof *rig->expression);
	memcpy(rig->aperture_px, motion->aperture_px, sizeof rig->aperture_px);
	allocate(rig, ch->mesh);
	take_camera(rig, motion, ch->subject_from_target);
	rig_expect_globes(center, &radius, rig, ch);
	bool ok = rig_find_globes(rig, (const double(*)[3])center, radius, conf, report, err);
	if (ok) {
		rig_take_homes(rig, motion, ch);
		take_gaps(rig, report);
		take_tracked(rig, motion, ch, conf->min_confidence, report);
		rig_spread(rig, conf);
		extrapolate(rig);
		px_per_mm = rig_px_per_mm(rig, motion, ch);
		rig_follow_lids(rig, motion, px_per_mm, conf->lid, report);
		rig_arc_margins(rig, motion, px_per_mm, conf);
		if (conf->seal >= 0)
			rig_seal_lids(rig, motion, px_per_mm, conf->seal, report);
		take_thickness(rig, conf);
		count(report, rig);
		ok = report->tracked > 0 || err_set(err, "no vertex of the character lies on tracked skin");
		ok = ok && rig_take_skull(rig, motion, ch, conf->map_step, smooth_mm * px_per_mm, err);
	}
	if (ok && conf->lid > 0)
		rig_unfold_lids(rig, motion, px_per_mm);
	if (ok)
		rig_line_lids(rig, conf);
	if (!ok)
		rig_free(rig);
	return ok;
}
