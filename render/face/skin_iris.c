/* The iris of the person in the film, for characters whose eyes nobody photographed (lib/draw/photo/filmed.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/json.h"
#include "base/mem.h"
#include "draw/photo/filmed.h"
#include "math/stats.h"
#include "render/face/skin_tracked.h"
#include "track/gaze/globe.h"

const char *const iris_sources[] = { "auto", "video", "plain", 0 };

static const char gaze_csv[] = "work/skin/gaze.csv";
static const int iris_files[] = { TRACKED_JSON, TRACKED_HEAD, TRACKED_LIDS };

enum { LONGEST = 3600, ALIKE = 8 };
static const double open_least = 0.6;      // of how wide the eye mostly stands open: what is narrower hides the iris, or is a blink
static const double sure_least = 0.3;
static const double open_deg = 10;         // of gaze that count as much as a lid's whole way, where frames are to differ

struct iris_film {
	struct tracked f;
	struct csv_table gaze;
	int column[2][5];          // h, v, torsion, opening, confidence
	const struct eye *eye;
	int n;
	long frame[FILMED_VIEWS];
	struct filmed *filmed[2];
};

static const char *relative(struct stage *stage, const char *rel)
{
	return stage_path(stage, "%s", rel) + strlen(stage->capture) + 1;
}

static const char *film_of(struct skin_job *job)
{
	struct err none = { 0 };
	bool there = job->conf->iris != IRIS_PLAIN && file_exists(stage_path(job->stage, "%s", gaze_csv));
	for (int i = 0; i < job->photographed->n; i++)
		there = there && !job->photographed->job[i].usable;
	for (int i = 0; i < COUNT(iris_files); i++)
		there = there && file_exists(stage_path(job->stage, "%s", tracked_files[iris_files[i]]));
	json_t *track = there ? json_read(stage_path(job->stage, "%s", tracked_files[TRACKED_JSON]), 1 << 24, &none) : 0;
	const char *film = json_string_value(json_object_get(track, "video"));
	film = film && skin_is_inside(job->stage, film) ? relative(job->stage, film) : 0;
	json_decref(track);
	return film;
}

void skin_iris(struct skin_target *t, struct skin_job *job)
{
	const char *film = film_of(job);
	if (!film)
		return;
	t->in[t->n_in++] = film;
	t->in[t->n_in++] = relative(job->stage, gaze_csv);
	for (int i = 0; i < COUNT(iris_files); i++)
		t->in[t->n_in++] = relative(job->stage, tracked_files[iris_files[i]]);
}

static bool load(struct iris_film *w, struct skin_job *job, struct err *err)
{
	static const char *const columns[2][5] = { { "g1_deg", "g2_deg", "g3_deg", "g4_px", "confidence_left" }, { "g6_deg", "g7_deg", "g8_deg", "g9_px", "confidence_right" } };
	const char *path = stage_path(job->stage, "%s", gaze_csv);
	bool ok = tracked_load_eyes(&w->f, job, err) && csv_read(&w->gaze, path, err);
	for (int s = 0; s < 2 && ok; s++)
		for (int k = 0; k < 5 && ok; k++)
			ok = (w->column[s][k] = csv_need(&w->gaze, columns[s][k], path, err)) >= 0;
	return ok && (w->gaze.n_rows == w->f.frames || err_set(err, "%s: not of the video's frames: run track again", gaze_csv));
}

static double of(const struct iris_film *w, long frame, int side, int what)
{
	return csv_at(&w->gaze, frame, w->column[side][what]);
}

/* How wide an eye mostly stands open, px. */
static double mostly_open(const struct iris_film *w, int side, long first, long last)
{
	double *wide = mem_new((size_t)(last - first) + 1, sizeof *wide);
	int n = 0;
	for (long i = first; i < last; i++)
		if (isfinite(of(w, i, side, 3)))
			wide[n++] = of(w, i, side, 3);
	const double out = n ? stats_quantile(n, wide, 0.75) : NAN;
	free(wide);
	return out;
}

/* Whether both eyes are open and known. */
static bool is_good(const struct iris_film *w, long frame, const double wide[2])
{
	bool good = isfinite(tracked_pose(&w->f, frame)[2][3]);
	for (int s = 0; s < 2; s++)
		good = good && isfinite(of(w, frame, s, 0) + of(w, frame, s, 1)) && of(w, frame, s, 3) > open_least * wide[s] && of(w, frame, s, 4) > sure_least;
	return good;
}

/* How unlike two frames are in gaze and opening, deg. */
static double unlike(const struct iris_film *w, long a, long b, const double wide[2])
{
	double d = 0;
	for (int s = 0; s < 2; s++) {
		d = fmax(d, hypot(of(w, a, s, 0) - of(w, b, s, 0), of(w, a, s, 1) - of(w, b, s, 1)));
		d = fmax(d, open_deg * fabs(of(w, a, s, 3) - of(w, b, s, 3)) / wide[s]);
	}
	return d;
}

/* The reference and frames like it, whose mean has less noise; then those that are as unlike all of them as there are: what a lid or a light hides in one frame
 * another shows. */
static void choose(struct iris_film *w)
{
	const struct tracked *f = &w->f;
	const long first = f->reference > LONGEST / 2 ? f->reference - LONGEST / 2 : 0, last = first + LONGEST < f->frames ? first + LONGEST : f->frames;
	const double wide[2] = { mostly_open(w, 0, first, last), mostly_open(w, 1, first, last) };
	double *apart = mem_new((size_t)(last - first) + 1, sizeof *apart);  // from the nearest frame taken; below 0: of no use, or taken
	long next = -1;
	for (long i = first; i < last; i++) {
		apart[i - first] = is_good(w, i, wide) ? INFINITY : -1;
		if (apart[i - first] > 0 && (next < 0 || labs(i - f->reference) < labs(next - f->reference)))
			next = i;
	}
	for (w->n = 0; next >= 0 && w->n < FILMED_VIEWS;) {
		w->frame[w->n++] = next;
		apart[next - first] = -1;
		for (long i = first; i < last; i++)
			if (apart[i - first] >= 0)
				apart[i - first] = fmin(apart[i - first], unlike(w, i, next, wide));
		next = -1;
		for (long i = first; i < last; i++)
			if (apart[i - first] >= 0
			    && (next < 0 || (w->n < ALIKE ? unlike(w, i, w->frame[0], wide) < unlike(w, next, w->frame[0], wide) : apart[i - first] > apart[next - first])))
				next = i;
	}
	free(apart);
}

/* Pose of an eye in a frame, in the mm of job->eye: its limbus is the eye's own. */
static void pose_of(struct fit *fit, const struct iris_film *w, long frame, int side)
{
	const double (*head)[4] = tracked_pose(&w->f, frame), unit = w->f.limbus[side] / w->eye->limbus_radius, radius = w->f.eye_radius[side], limbus = w->f.limbus[side];
	double turn[3][3], fick[3], apex[3];
	for (int k = 0; k < 3; k++)
		fick[k] = of(w, frame, side, k) * M_PI / 180;
	fick[2] = isfinite(fick[2]) ? fick[2] : 0;
	gaze_rotation(turn, fick);
	const double out = sqrt(radius * radius - limbus * limbus) + unit * eye_limbus_depth(w->eye);
	for (int k = 0; k < 3; k++)
		apex[k] = w->f.eye[side][k] + out * turn[k][2];
	*fit = (struct fit){ .ok = true, .camera = w->f.camera, .width = w->f.width, .height = w->f.height, .limbus_aspect = 1 };
	for (int i = 0; i < 3; i++) {
		for (int k = 0; k < 3; k++) {
			// The eye's y and z are those of a camera before it: down, and into it.
			for (int j = 0; j < 3; j++)
				fit->cam_from_eye[i][j] += head[i][k] * (j ? -turn[k][j] : turn[k][j]);
			fit->cam_from_eye[i][3] += head[i][k] * apex[k];
		}
		fit->cam_from_eye[i][3] = (fit->cam_from_eye[i][3] + head[i][3]) / unit;
	}
	fit->cam_from_eye[3][3] = 1;
}

static void take(void *to, int i, uint8_t *rgb)
{
	struct iris_film *w = to;
	const long m = w->f.lids.shape[2], frame = w->frame[i];
	for (int s = 0; s < 2; s++) {
		const float (*upper)[2] = (const float(*)[2])w->f.lids.data + (frame * TRACKED_MARGINS + 2 * s) * m;
		struct fit fit;
		pose_of(&fit, w, frame, s);
		filmed_add(w->filmed[s], &(struct filmed_view){ rgb, &fit, upper, upper + m, (int)m });
	}
	free(rgb);
}

/* Of the eye of which more is seen; where that will not do, of the other. */
static bool better(struct scene_seen *seen, struct filmed_report *report, int *side, struct iris_film *w, struct err *err)
{
	struct err why = { 0 };
	*side = filmed_share(w->filmed[1]) > filmed_share(w->filmed[0]);
	if (filmed_make(seen, report, w->filmed[*side], err))
		return true;
	*side = !*side;
	return filmed_make(seen, report, w->filmed[*side], &why);
}

bool skin_iris_of_film(struct scene_seen *seen, bool *found, struct skin_job *job, struct err *err)
{
	struct iris_film w = { .eye = job->eye };
	struct filmed_report r = { 0 };
	struct err why = { 0 };
	const char *film = film_of(job);
	int side;
	*found = false;
	if (!film)
		return true;
	bool ok = load(&w, job, &why);
	for (int s = 0; s < 2; s++)
		w.filmed[s] = filmed_new(job->eye, job->render->scene.sclera_radius, job->render->scene.sclera_rgb);
	if (ok)
		choose(&w);
	ok = ok && tracked_decode(w.n, w.frame, &w.f, job, stage_path(job->stage, "%s", film), &(struct tracked_take){ take, &w }, &why) && better(seen, &r, &side, &w, &why);
	for (int s = 0; s < 2; s++)
		filmed_free(w.filmed[s]);
	csv_table_free(&w.gaze);
	tracked_free(&w.f);
	if (!ok && job->conf->iris == IRIS_VIDEO)
		return err_set(err, "iris from %s: %s", film, why.msg);
	*found = ok;
	if (!ok) {
		stage_skipped(job->stage, "iris from %s: %s: it has render.iris_rgb's colour", film, why.msg);
		err_set(&job->iris_told, "of the colour of render.iris_rgb, their fibres drawn: there is no photograph of an eye, and %s does not give it: %s", film, why.msg);
		return true;
	}
	err_set(&job->iris_told, "of the person in %s, whose %s iris is %.0f px wide there; %.0f %% of it is seen in %d frames, the rest, and what is finer than %.2f mm, is drawn in its manner",
	        film, side ? "right" : "left", r.px, 100 * r.share, r.views, 2 * seen->finest);
	stage_note(job->stage, "iris of %s", job->iris_told.msg + strlen("of "));
	stage_figure(job->stage, "iris_seen", r.share, "share of the iris that the film shows");
	return true;
}
