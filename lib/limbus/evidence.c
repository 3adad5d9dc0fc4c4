#include "limbus/evidence.h"

#include <math.h>
#include <stdlib.h>

#include "base/call.h"
#include "base/mem.h"
#include "image/photo/part.h"
#include "image/plane.h"
#include "limbus/candidates.h"
#include "limbus/disc.h"
#include "net/net.h"

enum { STEP = 32, WINDOW_WIDE = 256, WINDOW_HIGH = 160, LONG_FIRST = 64, LONG_SURE = 256, LONG_LAST = 512, VIEWS_MAX = 12, CLOSE_WIDE = 128, CLOSE_HIGH = 96 };

struct evidence_net {
	struct net *net;
};

bool evidence_open(struct evidence_net **out, const char *path, struct err *err)
{
	struct net *net;
	*out = 0;
	if (!net_open(&net, path, (const int[3]){ 3, STEP, STEP }, (const int[3]){ EVIDENCE_CLASSES, STEP / 2, STEP / 2 }, err))
		return false;
	*out = mem_new(1, sizeof **out);
	(*out)->net = net;
	return true;
}

bool evidence_open_shipped(struct evidence_net **net, struct err *err)
{
	char *path = call_config_file("evidence.onnx");
	const bool ok = evidence_open(net, path, err);
	free(path);
	return ok;
}

void evidence_close(struct evidence_net *net)
{
	if (net)
		net_close(net->net);
	free(net);
}

static void softmax(float *planes, long n)
{
#pragma omp parallel for
	for (long i = 0; i < n; i++) {
		float most = planes[i], sum = 0;
		for (int c = 1; c < EVIDENCE_CLASSES; c++)
			most = fmaxf(most, planes[c * n + i]);
		for (int c = 0; c < EVIDENCE_CLASSES; c++)
			sum += planes[c * n + i] = expf(planes[c * n + i] - most);
		for (int c = 0; c < EVIDENCE_CLASSES; c++)
			planes[c * n + i] /= sum;
	}
}

/* The mirror image of n planes; free(). */
static float *mirrored(const float *planes, int n, int width, int height)
{
	float *out = mem_array((size_t)n * (size_t)width * (size_t)height, sizeof *out);
	for (long row = 0; row < (long)n * height; row++)
		for (int x = 0; x < width; x++)
			out[row * width + x] = planes[row * width + width - 1 - x];
	return out;
}

/* A part of the photograph as the network is given it: both sides are multiples of STEP. */
struct view { double x0, y0, scale; int width, height; };

/* The planes of a picture; those of its mirror image, turned back, are averaged with them. */
static struct evidence planes_of(const struct view *view, const struct net_picture *p, const struct net_picture *mirror)
{
	const long n = (long)p->size[1] * p->size[2];
	softmax(p->out, n);
	if (mirror) {
		softmax(mirror->out, n);
		float *other = mirrored(mirror->out, EVIDENCE_CLASSES, p->size[2], p->size[1]);
		for (long i = 0; i < EVIDENCE_CLASSES * n; i++)
			p->out[i] = 0.5F * (p->out[i] + other[i]);
		free(other);
	}
	struct evidence out = { .width = p->size[2], .height = p->size[1], .x0 = view->x0, .y0 = view->y0, .scale = view->scale * view->width / p->size[2] };
	for (int c = 0; c < EVIDENCE_CLASSES; c++)
		out.plane[c] = p->out + c * n;
	return out;
}

/* A photograph, and the same with `scale` of its px in one; without it, null. */
struct source { const struct photo *photo, *small; double scale; };

static float *part_of(const struct source *s, const struct view *v)
{
	if (s->small && v->scale >= s->scale)
		return photo_part(s->small, v->x0 / s->scale, v->y0 / s->scale, v->scale / s->scale, v->width, v->height);
	return photo_part(s->photo, v->x0, v->y0, v->scale, v->width, v->height);
}

/* The planes of n views. both: the mean of what a view and its mirror image say, so that mirrored photographs have mirrored evidence. */
static bool classify(struct evidence *out, const struct view *view, int n, bool both, struct evidence_net *net, const struct source *source,
                     struct err *err)
{
	struct net_picture picture[2 * VIEWS_MAX] = { 0 };
	float *in[2 * VIEWS_MAX] = { 0 };
	const int runs = both ? 2 * n : n;
	for (int i = 0; i < n; i++) {
		const struct view *v = &view[i];
		in[i] = part_of(source, v);
		in[n + i] = both ? mirrored(in[i], 3, v->width, v->height) : 0;
	}
	for (int i = 0; i < runs; i++)
		picture[i] = (struct net_picture){ .in = in[i], .height = view[i % n].height, .width = view[i % n].width };
	const bool ok = net_run(picture, runs, net->net, 3, err);
	for (int i = 0; i < n; i++)
		out[i] = ok ? planes_of(&view[i], &picture[i], both ? &picture[n + i] : 0) : (struct evidence){ 0 };
	for (int i = 0; i < 2 * n; i++) {
		free(in[i]);
		if (i >= n)
			free(picture[i].out);
	}
	return ok;
}

bool evidence_window(struct evidence *out, struct evidence_net *net, const struct photo *photo, double cx, double cy, double radius,
                     struct err *err)
{
	const double scale = radius / EVIDENCE_RADIUS;
	const struct view view = { cx - 0.5 * WINDOW_WIDE * scale, cy - 0.5 * WINDOW_HIGH * scale, scale, WINDOW_WIDE, WINDOW_HIGH };
	return classify(out, &view, 1, true, net, &(struct source){ .photo = photo }, err);
}

bool evidence_glance(struct evidence out[], int n, const double place[][3], struct evidence_net *net, const struct photo *photo, struct err *err)
{
	struct view view[EVIDENCE_GLANCES];
	for (int i = 0; i < n; i++) {
		const double scale = place[i][2] / EVIDENCE_GLANCE;
		view[i] = (struct view){ place[i][0] - 0.5 * EVIDENCE_GLANCE_WIDE * scale, place[i][1] - 0.5 * EVIDENCE_GLANCE_HIGH * scale, scale, EVIDENCE_GLANCE_WIDE, EVIDENCE_GLANCE_HIGH };
	}
	return classify(out, view, n, false, net, &(struct source){ .photo = photo }, err);
}

/* What is added to reach a multiple of STEP lies on both sides. */
static struct view whole(const struct photo *photo, int long_px)
{
	struct view v = { .scale = fmax(photo->width, photo->height) / (double)long_px };
	v.width = (int)ceil(photo->width / v.scale / STEP - 0.01) * STEP;
	v.height = (int)ceil(photo->height / v.scale / STEP - 0.01) * STEP;
	v.x0 = 0.5 * (photo->width - v.width * v.scale);
	v.y0 = 0.5 * (photo->height - v.height * v.scale);
	return v;
}

bool evidence_whole(struct evidence *out, struct evidence_net *net, const struct photo *photo, int long_px, struct err *err)
{
	const struct view view = whole(photo, long_px);
	return classify(out, &view, 1, false, net, &(struct source){ .photo = photo }, err);
}

float evidence_at(const struct evidence *evidence, enum evidence_class class, double x, double y)
{
	return plane_sample(evidence->plane[class], evidence->width, evidence->height, (x - evidence->x0) / evidence->scale,
	                    (y - evidence->y0) / evidence->scale);
}

float evidence_eye(const struct evidence *e, long i)
{
	return e->plane[EVIDENCE_SCLERA][i] + e->plane[EVIDENCE_IRIS][i] + e->plane[EVIDENCE_PUPIL][i] + e->plane[EVIDENCE_REFLECTION][i];
}

float evidence_eye_at(const struct evidence *e, double x, double y)
{
	return evidence_at(e, EVIDENCE_SCLERA, x, y) + evidence_at(e, EVIDENCE_IRIS, x, y) + evidence_at(e, EVIDENCE_PUPIL, x, y) + evidence_at(e, EVIDENCE_REFLECTION, x, y);
}

void evidence_told(float out[EVIDENCE_TOLD], const struct evidence *e, double x, double y)
{
	out[0] = evidence_at(e, EVIDENCE_IRIS, x, y) + evidence_at(e, EVIDENCE_PUPIL, x, y);
	out[1] = evidence_at(e, EVIDENCE_SCLERA, x, y);
	out[2] = evidence_at(e, EVIDENCE_LASH, x, y);
	out[3] = evidence_at(e, EVIDENCE_REFLECTION, x, y);
}

void evidence_free(struct evidence *evidence)
{
	free(evidence->plane[0]);
	*evidence = (struct evidence){ 0 };
}

struct list { struct evidence_region region[CANDIDATES_MAX]; int n; };

/* The candidates that `of` tells in n views, among the others of the list. */
static bool look(struct list *list, const struct view *view, int n, bool both, int (*of)(struct evidence_region *, const struct evidence *),
                 struct evidence_net *net, const struct source *source, struct err *err)
{
	struct evidence e[VIEWS_MAX];
	if (!classify(e, view, n, both, net, source, err))
		return false;
	// Coarse to fine, though the largest was run first.
	for (int i = n - 1; i >= 0; i--) {
		struct evidence_region more[CANDIDATES_MAX];
		const int m = of(more, &e[i]);
		for (int k = 0; both && k < m; k++)
			disc_fit(&more[k], &e[i]);
		list->n = candidates_merge(list->region, list->n, more, m);
		evidence_free(&e[i]);
	}
	return true;
}

/* Round a candidate, at the scale where it has so many px of radius, but no larger than the photograph, and inside it where it can be:
 * a border that is repeated far is no eye's surroundings. */
static struct view close_view(const struct evidence_region *r, double radius, const struct photo *photo)
{
	const double scale = fmin(r->radius / radius, fmax((double)photo->width / CLOSE_WIDE, (double)photo->height / CLOSE_HIGH));
	const double most_x = photo->width - CLOSE_WIDE * scale, most_y = photo->height - CLOSE_HIGH * scale;
	const double x0 = fmin(fmax(r->x - 0.5 * CLOSE_WIDE * scale, fmin(most_x, 0)), fmax(most_x, 0));
	const double y0 = fmin(fmax(r->y - 0.5 * CLOSE_HIGH * scale, fmin(most_y, 0)), fmax(most_y, 0));
	return (struct view){ x0, y0, scale, CLOSE_WIDE, CLOSE_HIGH };
}

/* Replaces the candidates by what is found where they are, at scales where each has the radii that suit the network: what is not seen
 * again keeps a third of its score. coarse: their radii are guesses. */
static bool look_closer(struct list *list, bool coarse, struct evidence_net *net, const struct source *source, struct err *err)
{
	static const int radius[] = { 10, 20, 20 };
	for (int k = coarse ? 0 : 1; k < COUNT(radius); k++) {
		struct view view[VIEWS_MAX];
		const int n = list->n;
		for (int i = 0; i < n; i++) {
			const struct evidence_region *r = &list->region[i];
			view[i] = close_view(r, radius[k], source->photo);
			list->region[i].score /= 3;
		}
		if (!look(list, view, n, k + 1 == COUNT(radius), candidates_of, net, source, err))
			return false;
	}
	return true;
}

/* An iris for sure, and so large that the other eye need not be in the picture; or two. */
static bool enough(const struct list *list, int longer)
{
	const double sure = 0.6, far = 0.05;
	const struct evidence_region *r = list->region;
	return list->n > 0 && r[0].score > sure && (r[0].radius > far * longer || (list->n > 1 && r[1].score > sure));
}

static bool search(struct list *list, struct evidence_net *net, const struct source *source, struct err *err)
{
	const struct photo *photo = source->photo;
	const int longer = photo->width > photo->height ? photo->width : photo->height;
	struct view view[VIEWS_MAX];
	int n = 0;
	// Enlarged pictures show nothing new; the first scale is looked at in any case.
	for (int size = LONG_SURE; size >= LONG_FIRST; size /= 2)
		if (size == LONG_FIRST || size < 2 * longer)
			view[n++] = whole(photo, size);
	if (!look(list, view, n, false, candidates_of, net, source, err) || !look_closer(list, false, net, source, err))
		return false;
	if (enough(list, longer))
		return true;
	struct list small = { 0 };
	view[0] = whole(photo, longer < LONG_LAST ? longer : LONG_LAST);
	if (!look(&small, view, 1, false, candidates_spots, net, source, err) || !look_closer(&small, true, net, source, err))
		return false;
	list->n = candidates_merge(list->region, list->n, small.region, small.n);
	return true;
}

bool evidence_find(struct evidence_region out[EVIDENCE_REGIONS], int *n, struct evidence_net *net, const struct photo *photo, struct err *err)
{
	double scale;
	struct photo small = photo_reduced(photo, 2 * LONG_LAST, &scale);
	struct list list = { 0 };
	const bool ok = search(&list, net, &(struct source){ photo, &small, scale }, err);
	photo_free(&small);
	*n = ok ? list.n < EVIDENCE_REGIONS ? list.n : EVIDENCE_REGIONS : 0;
	for (int i = 0; i < *n; i++)
		out[i] = list.region[i];
	return ok;
}
