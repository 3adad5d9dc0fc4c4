#include "tests/lib/score/skin_points.h"
#include "tests/lib/score/skin_moved.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "base/mem.h"
#include "base/npy/npy.h"
#include "image/video/video.h"

enum { TENTH = 10, NEAR = 24, NEIGHBOURS = 12, OUTLINE = 128 };

struct truth {
	double *px, *visible;          // [n][all][2], [n][all]
	long n, all;
	int n_outlines;
	double outline[2][OUTLINE][2]; // of the openings in the first frame
	int outline_n[2];
};

static double *array(long shape[6], const char *dir, const char *name)
{
	struct npy a;
	struct err none = { 0 };
	char *path = mem_printf("%s/truth.npz", dir);
	bool ok = npz_read(&a, path, name, NPY_LIMIT, &none);
	free(path);
	if (!ok)
		return 0;
	memcpy(shape, a.shape, 6 * sizeof *shape);
	double *x = npy_doubles(&a);
	npy_free(&a);
	return x;
}

static bool load(struct truth *t, const char *dir, struct err *err)
{
	static const char *const sides[] = { "left", "right" };
	long shape[6], upper[6] = { 0 }, lower[6] = { 0 };
	*t = (struct truth){ 0 };
	t->px = array(shape, dir, "skin_px");
	if (!t->px)
		return err_set(err, "%s/truth.npz: no skin_px", dir);
	t->n = shape[0];
	t->all = shape[1];
	t->visible = array(shape, dir, "skin_visible");
	for (int e = 0; e < 2; e++) {
		char name[2][64];
		snprintf(name[0], sizeof name[0], "lid_upper_px_%s", sides[e]);
		snprintf(name[1], sizeof name[1], "lid_lower_px_%s", sides[e]);
		double *up = array(upper, dir, name[0]), *low = array(lower, dir, name[1]);
		for (long i = 0; up && low && i < upper[1] + lower[1]; i++) {
			const double *p = i < upper[1] ? up + 2 * i : low + 2 * (lower[1] - 1 - (i - upper[1]));
			memcpy(t->outline[t->n_outlines][t->outline_n[t->n_outlines]++], p, 2 * sizeof *p);
		}
		t->n_outlines += up && low;
		free(up);
		free(low);
	}
	return true;
}

static bool in_opening(const struct truth *t, double x, double y)
{
	bool in = false;
	for (int e = 0; e < t->n_outlines; e++)
		for (int i = 0, j = t->outline_n[e] - 1; i < t->outline_n[e]; j = i++) {
			const double *p = t->outline[e][i], *q = t->outline[e][j];
			if ((p[1] > y) != (q[1] > y) && x < (q[0] - p[0]) * (y - p[1]) / (q[1] - p[1]) + p[0])
				in = !in;
		}
	return in;
}

static bool over_skin(const struct truth *t, const double a[2], const double b[2])
{
	for (int i = 1; i < 20; i++)
		if (in_opening(t, a[0] + 0.05 * i * (b[0] - a[0]), a[1] + 0.05 * i * (b[1] - a[1])))
			return false;
	return true;
}

/* Neighbours in the picture that no opening parts. */
static void join(struct skin_points *p, const struct truth *t)
{
	int(*edge)[2] = mem_new((size_t)p->n * NEAR + 1, sizeof *edge), n_edges = 0;
	for (int i = 0; i < p->n; i++) {
		int near[NEAR], n = 0;
		double d2[NEAR];
		for (int j = 0; j < p->n; j++) {
			double d = pow(p->at[i][0] - p->at[j][0], 2) + pow(p->at[i][1] - p->at[j][1], 2);
			if (j == i || (n == NEAR && d >= d2[NEAR - 1]) || !over_skin(t, p->at[i], p->at[j]))
				continue;
			int k = n < NEAR ? n++ : NEAR - 1;
			for (; k > 0 && d2[k - 1] > d; k--) {
				d2[k] = d2[k - 1];
				near[k] = near[k - 1];
			}
			d2[k] = d;
			near[k] = j;
		}
		for (int k = 0; k < n; k++, n_edges++) {
			edge[n_edges][0] = i;
			edge[n_edges][1] = near[k];
		}
	}
	skin_points_join(p, n_edges, (const int(*)[2])edge, NEIGHBOURS);
	free(edge);
}

static int *choose(struct skin_points *p, const struct truth *t, int most)
{
	int *row = mem_new((size_t)t->all + 1, sizeof *row);
	*p = (struct skin_points){ .at = mem_new((size_t)t->all + 1, sizeof *p->at) };
	for (double gap = 4;; gap *= 1.05) {
		p->n = 0;
		for (long i = 0; i < t->all; i++) {
			const double *q = t->px + 2 * i;
			bool take = t->visible[i] > 0 && q[0] > 3 && q[1] > 3 && q[0] < 1277 && q[1] < 717;
			for (int k = 0; k < p->n && take; k++)
				take = hypot(p->at[k][0] - q[0], p->at[k][1] - q[1]) >= gap;
			if (take) {
				memcpy(p->at[p->n], q, sizeof p->at[0]);
				row[p->n++] = (int)i;
			}
		}
		if (p->n <= most)
			break;
	}
	join(p, t);
	return row;
}

struct sums {
	double *all, *first, *last, *again, sight;
	long n, n_first, n_last, n_again;
	struct skin_moved *moved;  // [n_first] of the first tenth
	double far[SKIN_MOTIONS];  // of the last tenth: points that have moved as far as that
};

/* Errors of one frame; `again`: shown after the end of the clip. */
static void count(struct sums *s, const struct truth *t, const struct skin_point_state *state, int n, const int *row, long f, bool again)
{
	for (int i = 0; i < n; i++) {
		long k = f * t->all + row[i];
		if (!(t->visible[k] > 0))
			continue;
		s->sight += !again;
		if (!(state[i].confidence > 0))
			continue;
		double e = hypot(state[i].at[0] - t->px[2 * k], state[i].at[1] - t->px[2 * k + 1]);
		if (again) {
			s->again[s->n_again++] = e;
			continue;
		}
		s->all[s->n++] = e;
		int far = skin_how_far(t->px + 2 * k, t->px + 2 * row[i]);
		if (f < t->n / TENTH) {
			s->moved[s->n_first] = (struct skin_moved){ e, far };
			s->first[s->n_first++] = e;
		}
		if (f >= t->n - t->n / TENTH) {
			s->far[far]++;
			s->last[s->n_last++] = e;
		}
	}
}

static double now(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

struct follower {
	const struct skin_points_way *way;
	const struct skin_points *points;
	const uint8_t *mask;
	struct skin_track *track;
	uint8_t *first, *last;  // pictures of the flow: what it is compared with, and the newest
	double (*at)[2];
};

static bool push_flow(struct follower *w, const uint8_t *luma, long stride, int width, int height, struct skin_point_state *state, struct err *err)
{
	size_t area = (size_t)width * (size_t)height;
	bool begin = !w->first, ok = true;
	if (begin) {
		w->first = mem_new(area, 1);
		w->last = mem_new(area, 1);
		w->at = mem_array((size_t)w->points->n + 1, sizeof *w->at);
		memcpy(w->at, w->points->at, (size_t)w->points->n * sizeof *w->at);
	}
	for (int y = 0; y < height; y++)
		memcpy((begin ? w->first : w->last) + (size_t)y * (size_t)width, luma + y * stride, (size_t)width);
	if (!begin)
		ok = cv_flow(w->at, w->way->chained ? w->at : w->points->at, w->points->n, w->first, w->last, width, height, w->way->flow, err);
	if (!begin && w->way->chained)
		memcpy(w->first, w->last, area);
	for (int i = 0; i < w->points->n; i++)
		state[i] = (struct skin_point_state){ .at = { w->at[i][0], w->at[i][1] }, .confidence = 1 };
	return ok;
}

static bool push(struct follower *w, const uint8_t *luma, long stride, int width, int height, struct skin_point_state *state, struct err *err)
{
	if (!w->way->conf)
		return push_flow(w, luma, stride, width, height, state, err);
	if (!w->track)
		w->track = skin_track_new(w->points, luma, (int)stride, width, height, w->mask, w->way->conf);
	skin_track_push(w->track, luma, (int)stride, state);
	return true;
}

static void follower_free(struct follower *w)
{
	skin_track_free(w->track);
	free(w->first);
	free(w->last);
	free(w->at);
}

bool skin_points_follow(struct skin_points_score *score, const char *dir, int most, const struct skin_points_way *way, struct err *err)
{
	struct truth t;
	struct skin_points points;
	struct video_info info;
	if (!load(&t, dir, err))
		return false;
	int *row = choose(&points, &t, most);
	size_t room = (size_t)t.n * (size_t)points.n + 1;
	struct sums s = { .all = mem_new(room, sizeof(double)), .first = mem_new(room, sizeof(double)), .last = mem_new(room, sizeof(double)), .again = mem_new(room, sizeof(double)), .moved = mem_array(room, sizeof(struct skin_moved)) };
	struct skin_point_state *state = mem_new((size_t)points.n + 1, sizeof *state);
	char *path = mem_printf("%s/video.mp4", dir);
	struct video *video = video_open(&info, path, &(struct video_conf){ 40, 100000, 2, 0 }, err);
	long n_frames = way->frames && way->frames < t.n ? way->frames : t.n;
	size_t area = (size_t)info.width * (size_t)info.height;
	long tenth = t.n / TENTH;
	uint8_t *begin = mem_new(area * (size_t)tenth + 1, 1);
	uint8_t *mask = mem_new(area + 1, 1);
	for (long i = 0; i < (long)info.width * info.height; i++)
		mask[i] = in_opening(&t, (double)(i % info.width) + 0.5, (double)(i / info.width) + 0.5) ? 0 : 255;
	struct follower follower = { .way = way, .points = &points, .mask = mask };
	bool got = video != 0;
	double seconds = 0;
	for (long f = 0; got && f < n_frames; f++) {
		struct video_frame frame;
		got = video_next(&frame, &got, video, err) && got;
		double start = now();
		if (got && push(&follower, frame.luma, frame.luma_stride, frame.width, frame.height, state, err)) {
			seconds += now() - start;
			count(&s, &t, state, points.n, row, f, false);
			for (int y = 0; y < frame.height && f < tenth; y++)
				memcpy(begin + (size_t)f * area + (size_t)y * (size_t)frame.width, frame.luma + (long)y * frame.luma_stride, (size_t)frame.width);
		}
		video_frame_free(&frame);
	}
	for (long f = 0; follower.track && n_frames == t.n && f < tenth; f++) {
		skin_track_push(follower.track, begin + (size_t)f * area, info.width, state);
		count(&s, &t, state, points.n, row, f, true);
	}
	*score = (struct skin_points_score){ points.n, spread_of(s.n, s.all), spread_of(s.n_first, s.first), spread_of(s.n_last, s.last), spread_of(s.n_again, s.again),
		                                 skin_alike(s.n_first, s.moved, s.far), (double)s.n / fmax(1, s.sight), seconds / (double)n_frames };
	follower_free(&follower);
	video_close(video);
	skin_points_free(&points);
	free(row);
	free(mask);
	free(path);
	free(state);
	free(s.all);
	free(s.first);
	free(s.last);
	free(s.again);
	free(s.moved);
	free(begin);
	free(t.px);
	free(t.visible);
	return !err_is(err);
}
