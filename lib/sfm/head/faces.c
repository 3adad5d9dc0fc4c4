#include "sfm/head/faces.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "bridge/cv_face.h"
#include "image/picture.h"

enum { MOST_FACES = 4, TURNS = 4, NUMBERS = 7, FILE_LIMIT = 64 << 20 };

struct search {
	json_t *known;  // picture -> for each turn that was tried the faces, each seven numbers: left eye, right eye, mouth, whether that was found
	struct cv_face_finder *finder;
	struct stage *stage;
	const struct calibrate_options *o;
	int searched;  // pictures, each way up
	bool changed;
};

/* Rounds to a float, which the file's digits hold exactly: cached and fresh detections are the same to the bit. */
static double rounded(double x)
{
	return (float)x;
}

static bool is_face(const json_t *j)
{
	const double most = 1e6;  // px: far outside any picture
	bool ok = json_array_size(j) == NUMBERS;
	for (size_t k = 0; k < NUMBERS && ok; k++)
		ok = json_is_number(json_array_get(j, k)) && fabs(json_number_value(json_array_get(j, k))) <= most;
	return ok;
}

/* The cached detections of a picture turned so; null where it was not searched, or where the entry is malformed. Borrowed. */
static const json_t *recall(const struct search *s, const char *picture, int turn)
{
	const json_t *found = json_array_get(json_object_get(s->known, picture), (size_t)turn);
	bool ok = json_is_array(found) && json_array_size(found) <= MOST_FACES;
	for (size_t k = 0; ok && k < json_array_size(found); k++)
		ok = is_face(json_array_get(found, k));
	return ok ? found : 0;
}

static void remember(struct search *s, const char *picture, int turn, json_t *found)
{
	if (!json_array_size(json_object_get(s->known, picture)))
		json_object_set_new(s->known, picture, json_array());
	json_t *turns = json_object_get(s->known, picture);
	// Turns are tried in order; an invalid entry is replaced, and all behind it are dropped.
	while (json_array_size(turns) > (size_t)turn)
		json_array_remove(turns, json_array_size(turns) - 1);
	json_array_append_new(turns, found);
	s->changed = true;
	s->searched++;
}

static bool look_at(struct search *s, const char *picture, int turn, struct err *err)
{
	struct cv_face found[MOST_FACES];
	uint8_t *px;
	int w, h, n;
	if (!picture_read(&px, &w, &h, stage_path(s->stage, CALIBRATE_DIR "/pictures/%s", picture), s->o->limit_mpx, err))
		return false;
	for (long k = 0; k < (long)w * h; k++)
		px[k] = px[3 * k + 1];
	bool ok = cv_face_find(&n, found, MOST_FACES, s->finder, px, w, h, turn, err);
	free(px);
	if (!ok)
		return false;
	json_t *list = json_array();
	for (int k = 0; k < n; k++) {
		const struct cv_face *f = &found[k];
		const double x[NUMBERS] = { rounded(f->eye[0][0]), rounded(f->eye[0][1]), rounded(f->eye[1][0]),
			                        rounded(f->eye[1][1]), rounded(f->mouth[0]), rounded(f->mouth[1]), f->mouth_found };
		json_array_append_new(list, json_numbers(NUMBERS, x));
	}
	remember(s, picture, turn, list);
	return true;
}

static void take(struct faces *faces, const json_t *found, int image)
{
	for (size_t k = 0; k < json_array_size(found); k++) {
		double x[NUMBERS];
		for (size_t i = 0; i < NUMBERS; i++)
			x[i] = rounded(json_number_value(json_array_get(json_array_get(found, k), i)));
		faces->f[faces->n++] = (struct sfm_face){ image, { { x[0], x[1] }, { x[2], x[3] } }, { x[4], x[5] }, x[6] > 0 };
	}
	faces->images += json_array_size(found) > 0;
}

static bool look(struct faces *faces, struct search *s, const struct colmap_model *m, int turn, struct err *err)
{
	static const char *const what[TURNS] = { "faces", "faces, a quarter turned", "faces, upside down", "faces, three quarters turned" };
	for (int i = 0; i < m->n_images; i++) {
		const char *picture = m->images[i].name;
		if (!recall(s, picture, turn)) {
			if (!look_at(s, picture, turn, err))
				return false;
			stage_progress(s->stage, i + 1, m->n_images, what[turn]);
		}
		take(faces, recall(s, picture, turn), i);
	}
	return true;
}

/* Writes the cache where it changed; pictures that are not in the model are dropped. */
static bool save(struct search *s, const struct colmap_model *m, const char *path, struct err *err)
{
	json_t *all = json_object();
	for (int i = 0; i < m->n_images; i++)
		json_object_set(all, m->images[i].name, json_object_get(s->known, m->images[i].name));
	s->changed = s->changed || json_object_size(all) != json_object_size(s->known);
	bool ok = !s->changed || json_write(path, all, 0, err);
	json_decref(all);
	return ok;
}

static int by_image(const void *a, const void *b)
{
	const struct sfm_face *p = a, *q = b;
	return p->image != q->image ? p->image - q->image : p->eye[0][0] < q->eye[0][0] ? -1 : p->eye[0][0] > q->eye[0][0];
}

bool faces_find(struct faces *faces, const struct colmap_model *model, int least, struct stage *stage,
                const struct calibrate_options *o, struct err *err)
{
	const char *path = stage_path(stage, CALIBRATE_DIR "/faces.json");
	struct search s = { .stage = stage, .o = o };
	struct err none = { 0 };
	*faces = (struct faces){ .n = 0 };
	if (!cv_face_open(&s.finder, err)) {
		stage_skipped(stage, "eyes in the views: %s", err->msg);
		*err = (struct err){ 0 };
		return true;
	}
	s.known = file_exists(path) ? json_read(path, FILE_LIMIT, &none) : 0;
	if (!s.known)
		s.known = json_object();
	faces->f = mem_new((size_t)model->n_images * MOST_FACES * TURNS, sizeof *faces->f);
	bool ok = true;
	int turn = 0;
	// Most cameras are held upright: further turns only where that finds too few faces.
	for (; turn < TURNS && ok && (!turn || faces->images < least); turn++)
		ok = look(faces, &s, model, turn, err);
	if (ok && s.searched < turn * model->n_images)
		stage_skipped(stage, "faces: of %d searches, each picture %d of 4 ways up, %d were done by an earlier run", turn * model->n_images, turn,
		              turn * model->n_images - s.searched);
	ok = ok && save(&s, model, path, err);
	qsort(faces->f, (size_t)faces->n, sizeof *faces->f, by_image);
	cv_face_close(s.finder);
	json_decref(s.known);
	return ok;
}

void faces_free(struct faces *faces)
{
	free(faces->f);
}
