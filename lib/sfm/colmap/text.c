#include <ctype.h>
#include <errno.h>
#include <stdlib.h>

#include "base/mem.h"
#include "sfm/colmap/parse_impl.h"

/* Lines of a text, comments left out; words of a line. Nothing is copied: the text ends with a zero byte. */
struct lines {
	const char *at, *end;    // of what is left
	const char *word, *stop; // of the present line
	long number;
	const char *where;
	struct err *err;
};

/* The next line; `blank`: an empty one counts (an image without observations has one). */
static bool next_line(struct lines *l, bool blank)
{
	while (l->at < l->end) {
		const char *newline = memchr(l->at, '\n', (size_t)(l->end - l->at));
		l->word = l->at;
		l->stop = newline ? newline : l->end;
		l->at = newline ? newline + 1 : l->end;
		l->number++;
		while (l->word < l->stop && isspace((unsigned char)*l->word))
			l->word++;
		if (l->word < l->stop ? *l->word != '#' : blank)
			return true;
	}
	return false;
}

static bool wrong(struct lines *l, const char *rule)
{
	return err_set(l->err, "%s:%ld: %s", l->where, l->number, rule);
}

/* The next word of the line; its length, 0 at the end. */
static int next_word(const char **word, struct lines *l)
{
	while (l->word < l->stop && isspace((unsigned char)*l->word))
		l->word++;
	*word = l->word;
	while (l->word < l->stop && !isspace((unsigned char)*l->word))
		l->word++;
	return (int)(l->word - *word);
}

static bool real(double *out, struct lines *l)
{
	const char *word;
	char *end;
	int n = next_word(&word, l);
	*out = n ? strtod(word, &end) : 0;
	return n && end == word + n ? true : wrong(l, "a number is missing");
}

static bool reals(int n, double *out, struct lines *l)
{
	bool ok = true;
	for (int i = 0; i < n && ok; i++)
		ok = real(&out[i], l);
	return ok;
}

/* A whole number 0 .. limit; "-1", where the file means none, is UINT64_MAX. */
static bool whole(uint64_t *out, uint64_t limit, bool none, struct lines *l)
{
	const char *word;
	char *end;
	int n = next_word(&word, l);
	if (none && n == 2 && !memcmp(word, "-1", 2)) {
		*out = UINT64_MAX;
		return true;
	}
	errno = 0;
	*out = n ? strtoull(word, &end, 10) : 0;
	if (!n || end != word + n || !isdigit((unsigned char)*word) || errno || *out > limit)
		return wrong(l, "a whole number is missing or out of range");
	return true;
}

static bool at_end(struct lines *l)
{
	const char *word;
	return next_word(&word, l) ? wrong(l, "more on the line than belongs there") : true;
}

static bool camera_of(struct colmap_camera *camera, struct lines *l)
{
	uint64_t id, width, height;
	const char *word;
	if (!whole(&id, UINT32_MAX, false, l))
		return false;
	int n = next_word(&word, l), kind = 0;
	while (kind < COLMAP_KINDS
	       && ((int)strlen(colmap_kind_name((enum colmap_kind)kind)) != n || memcmp(colmap_kind_name((enum colmap_kind)kind), word, (size_t)n)))
		kind++;
	if (kind == COLMAP_KINDS)
		return wrong(l, "no such camera model");
	if (!whole(&width, 1000000, false, l) || !whole(&height, 1000000, false, l))
		return false;
	*camera = (struct colmap_camera){ (uint32_t)id, (enum colmap_kind)kind, (int)width, (int)height, { 0 } };
	return reals(colmap_kind_params(camera->kind), camera->params, l) && at_end(l);
}

static bool cameras(struct colmap_model *model, struct lines *l)
{
	while (next_line(l, false)) {
		model->cameras = mem_grow(model->cameras, (size_t)model->n_cameras + 1, sizeof *model->cameras);
		if (!camera_of(&model->cameras[model->n_cameras++], l))
			return false;
	}
	return true;
}

/* The first line of an image: id, pose, camera, and a name that may hold spaces. */
static bool image_head(struct colmap_image *image, uint32_t *camera, struct lines *l)
{
	uint64_t id, of;
	if (!whole(&id, UINT32_MAX, false, l) || !reals(4, image->q, l) || !reals(3, image->t, l)
	    || !whole(&of, UINT32_MAX, false, l))
		return false;
	image->id = (uint32_t)id;
	*camera = (uint32_t)of;
	const char *name, *stop = l->stop;
	if (!next_word(&name, l))
		return wrong(l, "the image has no name");
	while (stop > name && isspace((unsigned char)stop[-1]))
		stop--;
	image->name = mem_printf("%.*s", (int)(stop - name), name);
	return true;
}

static bool image_seen(struct colmap_image *image, struct colmap_raw *raw, struct lines *l)
{
	// No observation is shorter than "0 0 0 ".
	size_t most = (size_t)(l->stop - l->word) / 6 + 1;
	image->seen = mem_array(most, sizeof *image->seen);
	raw->seen_point = mem_grow(raw->seen_point, (size_t)raw->n_seen + most, sizeof *raw->seen_point);
	for (const char *word; next_word(&word, l);) {
		l->word = word;
		struct colmap_seen *seen = &image->seen[image->n_seen++];
		if (!reals(2, seen->px, l) || !whole(&raw->seen_point[raw->n_seen++], UINT64_MAX - 1, true, l))
			return false;
	}
	return true;
}

static bool images(struct colmap_model *model, struct colmap_raw *raw, struct lines *l)
{
	while (next_line(l, false)) {
		size_t n = (size_t)model->n_images + 1;
		model->images = mem_grow(model->images, n, sizeof *model->images);
		raw->image_camera = mem_grow(raw->image_camera, n, sizeof *raw->image_camera);
		struct colmap_image *image = &model->images[model->n_images++];
		*image = (struct colmap_image){ 0 };
		if (!image_head(image, &raw->image_camera[n - 1], l))
			return false;
		if (!next_line(l, true))
			return wrong(l, "the file ends before the image's observations");
		if (!image_seen(image, raw, l))
			return false;
	}
	return true;
}

static bool point_of(struct colmap_point *point, struct colmap_raw *raw, struct lines *l)
{
	uint64_t rgb[3], image, seen;
	if (!whole(&point->id, UINT64_MAX - 1, false, l) || !reals(3, point->xyz, l))
		return false;
	for (int i = 0; i < 3; i++) {
		if (!whole(&rgb[i], 255, false, l))
			return false;
		point->rgb[i] = (uint8_t)rgb[i];
	}
	if (!real(&point->error, l))
		return false;
	// No pair is shorter than "1 0 ".
	raw->track = mem_grow(raw->track, (size_t)raw->n_track + (size_t)(l->stop - l->word) / 4 + 1, sizeof *raw->track);
	for (const char *word; next_word(&word, l);) {
		l->word = word;
		if (!whole(&image, UINT32_MAX, false, l) || !whole(&seen, UINT32_MAX, false, l))
			return false;
		raw->track[raw->n_track].image = (uint32_t)image;
		raw->track[raw->n_track++].seen = (uint32_t)seen;
		point->n_track++;
	}
	return true;
}

static bool points(struct colmap_model *model, struct colmap_raw *raw, struct lines *l)
{
	while (next_line(l, false)) {
		int n = model->n_points;
		if (!(n & (n - 1)))  // grows by powers of two
			model->points = mem_grow(model->points, n ? 2 * (size_t)n : 1, sizeof *model->points);
		model->points[n] = (struct colmap_point){ 0 };
		model->n_points++;
		if (!point_of(&model->points[n], raw, l))
			return false;
	}
	return true;
}

bool colmap_parse_text(struct colmap_model *model, struct colmap_raw *raw, const char *const data[3],
                       const size_t size[3], const char *const where[3], struct err *err)
{
	struct lines l[3];
	for (int i = 0; i < 3; i++) {
		l[i] = (struct lines){ .at = data[i], .end = data[i] + size[i], .where = where[i], .err = err };
		if (memchr(data[i], 0, size[i]))
			return err_set(err, "%s: a zero byte in a text", where[i]);
	}
	return cameras(model, &l[0]) && images(model, raw, &l[1]) && points(model, raw, &l[2]);
}
