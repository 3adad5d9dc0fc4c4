#include "anatomy/keys.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/file.h"
#include "base/mem.h"

double camera_keys_focal(const struct camera_keys *keys, int width, int height)
{
	if (isfinite(keys->focal_px))
		return keys->focal_px;
	return keys->focal_mm / keys->sensor_mm * (width > height ? width : height);
}

bool camera_keys_agree(const struct camera_keys *keys, int width, int height, struct err *err)
{
	const double by_mm = keys->focal_mm / keys->sensor_mm * (width > height ? width : height);
	if (!isfinite(keys->focal_px) || !isfinite(by_mm) || fabs(keys->focal_px / by_mm - 1) <= 0.05)
		return true;
	return err_set(err, "camera.focal_px = %g, and camera.focal_mm = %g with camera.sensor_mm = %g, which make it %.6g px here: give the one that is true",
	               keys->focal_px, keys->focal_mm, keys->sensor_mm, by_mm);
}

bool camera_keys_place(double focal_px, double limbus_mm, double radius_px, struct err *err)
{
	const double mm = focal_px * limbus_mm / radius_px;
	if (mm >= 10 && mm <= 1e5)
		return true;
	return err_set(err, "camera.focal_px = %g with eye.limbus_radius_mm = %g: an iris of %.0f px stands %.3g mm before such a camera, must be 10 mm to 100 m",
	               focal_px, limbus_mm, radius_px, mm);
}

/* The undistorted radius of what stands at `corner` in the picture; NAN where the radius in the picture does not grow with it until there. */
static double undistorted(const double k[5], double corner)
{
	enum { STEPS = 4096 };
	// No lens that is told by this polynomial shows more than 85 degrees off its axis.
	const double most = tan(85 * M_PI / 180);
	double before = 0, at = 0;
	for (int i = 1; i <= STEPS && before < corner; i++) {
		double r = most * i * i / (STEPS * (double)STEPS), r2 = r * r, f = r * (1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4])));
		if (!(f > before))
			return NAN;
		before = f;
		at = r;
	}
	return before >= corner ? at : NAN;
}

bool camera_keys_check(const struct camera *camera, int width, int height, struct err *err)
{
	const double *c = camera->center_px, *k = camera->distortion;
	if (!(c[0] >= -width && c[0] <= 2.0 * width && c[1] >= -height && c[1] <= 2.0 * height))
		return err_set(err, "camera.center_px = %g %g: must lie within one picture's size of the picture, %d x %d px", c[0], c[1], width,
		               height);
	if (!isfinite(camera->focal_px))
		return true;
	double corner = hypot(fmax(fabs(c[0]), fabs(width - c[0])), fmax(fabs(c[1]), fabs(height - c[1]))) / camera->focal_px;
	const double at = undistorted(k, corner), far = corner / at;
	if (!isfinite(at))
		return err_set(err, "camera.distortion = %g %g %g %g %g with camera.focal_px = %g: folds the picture before its corners", k[0], k[1],
		               k[2], k[3], k[4], camera->focal_px);
	// Fisheyes halve it; a pincushion of a quarter is no lens.
	if (far < 0.1 || far > 1.25)
		return err_set(err, "camera.distortion = %g %g %g %g %g with camera.focal_px = %g: the corners stand %.2g times as far from the centre as without it, must be 0.1 to 1.25",
		               k[0], k[1], k[2], k[3], k[4], camera->focal_px, far);
	return true;
}

/* Keys FAMILY.NAME.* name a file of one of these folders. */
struct family {
	const char *prefix, *what;
	const char *folders[3];  // null-terminated
	bool frames;             // of a video of video/, too: STEM_NUMBER
	bool parts;              // one eye of a photograph that shows both, too: STEM.left, STEM.right
};

static const struct family families[] = {
	{ "photo.", "photograph", { "photos" }, false, true },
	{ "view.", "view", { "views", "photos" }, true, false },
	{ "target.", "character", { "targets" }, false, false },
};

/* Bytes of a file's name before its ending. */
static size_t stem_length(const char *file)
{
	const char *dot = strrchr(file, '.');
	return dot && dot != file ? (size_t)(dot - file) : strlen(file);
}

static bool is_stem(const char *file, const char *name, size_t length)
{
	return stem_length(file) == length && !strncmp(file, name, length);
}

/* name: "clip_120" of the file "clip.mp4". */
static bool is_frame(const char *file, const char *name, size_t length)
{
	size_t n = stem_length(file);
	if (length < n + 2 || strncmp(file, name, n) || name[n] != '_')
		return false;
	return strspn(name + n + 1, "0123456789") >= length - n - 1;
}

/* Bytes of the name of a photograph without the part of it that is meant. */
static size_t without_part(const char *name, size_t length)
{
	static const char *const parts[] = { ".left", ".right" };
	for (int i = 0; i < COUNT(parts); i++) {
		const size_t n = strlen(parts[i]);
		if (length > n && !strncmp(name + length - n, parts[i], n))
			return length - n;
	}
	return length;
}

/* Whether a file bears that name. *there gains the names that there are, each once; its owner frees it. */
static bool look(bool *found, char **there, const struct family *family, const char *capture, const char *name, size_t length,
                 struct err *err)
{
	enum { MOST = 12 };
	int n = 0;
	for (int f = 0; f < 3; f++) {
		const char *folder = f < 2 ? family->folders[f] : family->frames ? "video" : 0;
		struct file_list list = { 0 };
		if (!folder)
			continue;
		char *path = mem_printf("%s/%s", capture, folder);
		bool ok = file_list(&list, path, err);
		free(path);
		if (!ok)
			return false;
		for (int i = 0; i < list.n; i++) {
			const char *file = list.names[i];
			bool video = f == 2, twice = i && is_stem(list.names[i - 1], file, stem_length(file));
			*found |= video ? is_frame(file, name, length) : is_stem(file, name, length) || (family->parts && is_stem(file, name, without_part(name, length)));
			if (twice || ++n > MOST)
				continue;
			char *more = mem_printf("%s%s%.*s%s", *there, **there ? ", " : "", (int)stem_length(file), file, video ? "_FRAME" : "");
			free(*there);
			*there = more;
		}
		file_list_free(&list);
	}
	if (n > MOST) {
		char *more = mem_printf("%s and %d more", *there, n - MOST);
		free(*there);
		*there = more;
	}
	return true;
}

static bool check_one(const struct conf_item *item, const struct family *family, const char *capture, struct err *err)
{
	const char *name = item->key + strlen(family->prefix), *end = strrchr(name, '.');
	size_t length = end ? (size_t)(end - name) : strlen(name);
	char place[16] = "", *there = mem_str("");
	bool found = length == 1 && *name == '*';
	if (found || look(&found, &there, family, capture, name, length, err)) {
		if (item->line)
			snprintf(place, sizeof place, ":%d", item->line);
		if (!found)
			err_set(err, "%s%s: %s: no %s is called %.*s: %s%s", item->file, place, item->key, family->what, (int)length, name,
			        *there ? "there are " : "there is none", there);
	}
	free(there);
	return found;
}

bool keys_check_names(const struct conf *conf, const char *capture, struct err *err)
{
	for (int i = 0; i < conf->n; i++)
		for (int f = 0; f < COUNT(families); f++)
			if (conf->items[i].layer && !strncmp(conf->items[i].key, families[f].prefix, strlen(families[f].prefix))
			    && !check_one(&conf->items[i], &families[f], capture, err))
				return false;
	return true;
}
