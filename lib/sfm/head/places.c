#include "sfm/head/places.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "bridge/cv_marker.h"
#include "image/picture.h"
#include "math/stats.h"
#include "math/vec.h"

/* Least relative sigma of a length: rulers bend, and are read to a fraction of a millimetre. */
static const double least_sigma = 0.002;
/* Sigmas, px: of a point set by hand, and of a detected corner. */
static const double hand_px = 1.5, corner_px = 0.3;

/* Index of the registered image of the view of that name; -1: none. *scale: picture px for a px of the photograph. */
static int image_of(double *scale, const struct head *head, const struct views *views, const char *name)
{
	for (int i = 0; i < views->n_used; i++) {
		const struct colmap_image *im = view_is_named(&views->v[i], name) ? head_image(head, &views->v[i]) : 0;
		if (im) {
			*scale = (double)views->v[i].picture_width / views->v[i].width;
			return (int)(im - head->model->images);
		}
	}
	return -1;
}

static int sights_of(struct sfm_sight *out, int most, double *hand, const struct head *head, const struct views *views,
                     const struct opt_each_list *key, int which)
{
	int n = 0;
	for (int i = 0; i < key->n && n < most; i++) {
		double scale, *px = key->items[i].value + which;
		int image = image_of(&scale, head, views, key->items[i].name);
		if (image < 0)
			continue;
		*hand = hand_px * scale;
		out[n++] = (struct sfm_sight){ image, { px[0] * scale, px[1] * scale } };
	}
	return n;
}

enum { MOST_SIGHTS = 64 };

static bool place(double xyz[3], double *sigma, int *n, const struct head *head, const struct views *views,
                  const struct opt_each_list *key, int which, struct err *err)
{
	struct sfm_sight sights[MOST_SIGHTS];
	double hand = hand_px;
	*n = sights_of(sights, MOST_SIGHTS, &hand, head, views, key, which);
	return *n < 2 || sfm_triangulate(xyz, sigma, head->model, *n, sights, hand, err);
}

bool places_point(double xyz[3], bool *found, const struct head *head, const struct views *views,
                  const struct opt_each_list *key, int which, struct err *err)
{
	double sigma;
	int n;
	bool ok = place(xyz, &sigma, &n, head, views, key, which, err);
	*found = n >= 2;
	return ok;
}

static void add(struct places_lengths *out, double world, double mm, double sigma)
{
	if (out->n < PLACES_LENGTHS && world > 0)
		out->l[out->n++] = (struct sfm_length){ world, mm, fmax(least_sigma, sigma) };
}

static double apart(const double a[3], const double b[3])
{
	double d[3];
	vec_add(d, a, -1, b);
	return vec_norm(d);
}

bool places_ruler(struct places_lengths *out, const struct head *head, const struct views *views,
                  const struct calibrate_options *o, struct err *err)
{
	double end[2][3], sigma[2];
	int n[2];
	if (!o->ruler.n || !isfinite(o->ruler_mm))
		return !o->ruler.n || err_set(err, "capture.conf: view.%s.ruler_px is given: calibrate.ruler_mm must be too", o->ruler.items[0].name);
	for (int i = 0; i < 2; i++)
		if (!place(end[i], &sigma[i], &n[i], head, views, &o->ruler, 2 * i, err))
			return err_wrap(err, "capture.conf: view.*.ruler_px");
	if (n[0] < 2)
		return err_set(err, "capture.conf: view.*.ruler_px: must be given for two registered views or more, is for %d", n[0]);
	double world = apart(end[0], end[1]);
	add(out, world, o->ruler_mm, hypot(sigma[0], sigma[1]) / world);
	return true;
}

struct seen_marker {
	struct cv_marker m;
	int image;
};

/* Triangulates the corners of a marker that two pictures or more show, and adds its four sides. */
static void sides_of(struct places_lengths *out, const struct head *head, const struct seen_marker *seen, int n, int first,
                     double mm)
{
	double corner[4][3], sigma[4];
	for (int k = 0; k < 4; k++) {
		struct sfm_sight sights[MOST_SIGHTS];
		struct err none = { 0 };
		int found = 0;
		for (int i = first; i < n && found < MOST_SIGHTS; i++)
			if (seen[i].m.family == seen[first].m.family && seen[i].m.id == seen[first].m.id) {
				sights[found].image = seen[i].image;
				memcpy(sights[found++].px, seen[i].m.corner[k], sizeof sights->px);
			}
		if (!sfm_triangulate(corner[k], &sigma[k], head->model, found, sights, corner_px, &none))
			return;
	}
	double low = INFINITY, high = 0, side[4];
	for (int k = 0; k < 4; k++) {
		side[k] = apart(corner[k], corner[(k + 1) % 4]);
		low = fmin(low, side[k]);
		high = fmax(high, side[k]);
	}
	// Not a square: it was misread, or two markers have the same number.
	for (int k = 0; k < 4 && high < 1.1 * low; k++)
		add(out, side[k], mm, hypot(sigma[k], sigma[(k + 1) % 4]) / side[k]);
}

bool places_markers(struct places_lengths *out, const struct head *head, struct stage *stage,
                    const struct calibrate_options *o, struct err *err)
{
	enum { MOST = 64 };
	const struct colmap_model *m = head->model;
	struct cv_marker found[MOST];
	int n = 0, n_found;
	if (!isfinite(o->marker_mm))
		return true;
	struct seen_marker *seen = mem_new((size_t)m->n_images * MOST, sizeof *seen);
	bool ok = true;
	for (int i = 0; i < m->n_images && ok; i++) {
		uint8_t *px;
		int w, h;
		ok = picture_read(&px, &w, &h, stage_path(stage, CALIBRATE_DIR "/pictures/%s", m->images[i].name), o->limit_mpx, err);
		if (!ok)
			break;
		for (long k = 0; k < (long)w * h; k++)
			px[k] = px[3 * k + 1];
		ok = cv_markers(&n_found, found, MOST, px, w, h, err);
		for (int k = 0; k < n_found && ok; k++)
			seen[n++] = (struct seen_marker){ found[k], i };
		free(px);
	}
	for (int i = 0; i < n && ok; i++) {
		bool first = true;
		for (int k = 0; k < i; k++)
			first &= seen[k].m.family != seen[i].m.family || seen[k].m.id != seen[i].m.id;
		if (first)
			sides_of(out, head, seen, n, i, o->marker_mm);
	}
	free(seen);
	if (ok && !out->n)
		stage_skipped(stage, "scale: no marker found in two views: print an ArUco or AprilTag marker with a white margin, "
		              "lay it flat beside the head");
	return ok;
}

bool places_distances(struct places_lengths *out, const struct head *head, const struct views *views,
                      const struct calibrate_options *o, struct err *err)
{
	// The end points of the tape, on the camera and on the face, are uncertain by a few per cent of the distance.
	const double tape_sigma = 0.03;
	const struct colmap_model *m = head->model;
	for (int i = 0; i < o->distance.n; i++) {
		double scale, center[3];
		int image = image_of(&scale, head, views, o->distance.items[i].name), n = 0;
		if (image < 0)
			return err_set(err, "capture.conf: view.%s.distance_mm: no such view is registered", o->distance.items[i].name);
		const struct colmap_image *im = &m->images[image];
		const struct colmap_camera *c = &m->cameras[im->camera];
		double *d = mem_array((size_t)im->n_seen + 1, sizeof *d);
		colmap_center(center, im);
		for (int k = 0; k < im->n_seen; k++) {
			const double *px = im->seen[k].px;
			bool middle = fabs(px[0] / c->width - 0.5) < 1.0 / 6 && fabs(px[1] / c->height - 0.5) < 1.0 / 6;
			if (im->seen[k].point >= 0 && middle)
				d[n++] = apart(center, m->points[im->seen[k].point].xyz);
		}
		if (n >= 5)
			add(out, stats_median(n, d), o->distance.items[i].value[0], tape_sigma);
		free(d);
	}
	return true;
}
