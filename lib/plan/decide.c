#include "plan/decide.h"

#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/file.h"
#include "base/mem.h"
#include "base/record.h"
#include "image/photo/photo.h"
#include "plan/film.h"
#include "plan/meshes.h"

/* True when capture.conf gives the lens: of a video alone there is then nothing to find. */
static bool lens_given(const struct conf *conf)
{
	static const char *const keys[] = { "camera.focal_px", "camera.focal_mm", "camera.sensor_mm" };
	bool given[COUNT(keys)];
	for (int i = 0; i < COUNT(keys); i++) {
		const struct conf_item *item = conf_find(conf, keys[i], 0);
		given[i] = item && *item->value;
	}
	return given[0] || (given[1] && given[2]);
}

static bool ends_with(const char *s, const char *tail)
{
	size_t n = strlen(s), m = strlen(tail);
	return n > m && !strcmp(s + n - m, tail);
}

/* Appends a folder's names to the listing. n: out, how many of them end in one of `kinds` (null: all). */
static bool look(int *n, char **names, const char *capture, const char *dir, const char *const kinds[], struct err *err)
{
	struct file_list list;
	char *path = mem_printf("%s/%s", capture, dir);
	*n = 0;
	bool ok = file_list(&list, path, err);
	for (int i = 0; ok && i < list.n; i++) {
		bool counts = !kinds;
		for (int k = 0; kinds && kinds[k]; k++)
			counts |= ends_with(list.names[i], kinds[k]);
		*n += counts;
		char *more = mem_printf("%s%s/%s\n", *names, dir, list.names[i]);
		free(*names);
		*names = more;
	}
	file_list_free(&list);
	free(path);
	return ok;
}

static bool holdings(int *have, struct plan *plan, struct err *err)
{
	static const char *const meshes[] = { ".obj", ".ply", ".glb", ".gltf", ".fbx", 0 };
	static const struct {
		const char *dir;
		int bit, least;
		const char *const *kinds;
	} dirs[] = { { "photos", HAS_PHOTOS, 1, 0 },
		     { "views", HAS_VIEWS, 2, 0 },
		     { "video", HAS_VIDEO, 1, 0 },
		     { "targets", HAS_TARGETS, 1, meshes },
		     { "script", HAS_SCRIPT, 1, 0 } };
	char *names = mem_str("");
	bool ok = true;
	*have = 0;
	for (int i = 0; i < COUNT(dirs) && ok; i++) {
		int n;
		ok = look(&n, &names, plan->capture, dirs[i].dir, dirs[i].kinds, err);
		*have |= n >= dirs[i].least ? dirs[i].bit : 0;
		plan->n_photos = dirs[i].bit == HAS_PHOTOS ? n : plan->n_photos;
		plan->n_characters = dirs[i].bit == HAS_TARGETS ? n : plan->n_characters;
	}
	file_hash_bytes(plan->listing, names, strlen(names));
	free(names);
	return ok;
}

/* Megapixels of a photograph from the first part of its file, else estimated from the file's length. grey: whether its head says so. */
static double megapixels(bool *grey, const char *path)
{
	enum { HEAD = 1 << 18 };
	struct stat st;
	struct photo photo;
	struct err err = { 0 };
	int fd = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
	*grey = false;
	if (fd < 0)
		return 0;
	char *head = mem_array(HEAD, 1);
	ssize_t n = fstat(fd, &st) || !S_ISREG(st.st_mode) ? 0 : read(fd, head, HEAD);
	close(fd);
	photo_header(&photo, head, n > 0 ? (size_t)n : 0, 1e6, &err);  // "truncated" is no fault here
	free(head);
	*grey = photo.grey;
	if (photo.width > 0 && photo.height > 0)
		return 1e-6 * photo.width * photo.height;
	return n > 0 && photo.kind != PHOTO_NONE ? 1e-6 * (double)st.st_size / 3 : 0;
}

/* Sums up the photographs' sizes. Returns whether all of them say that they are grey. */
static bool measure(struct plan *plan)
{
	bool all_grey = true;
	struct file_list list;
	struct err err = { 0 };
	char *dir = mem_printf("%s/photos", plan->capture);
	file_list(&list, dir, &err);
	for (int i = 0; i < list.n; i++) {
		char *path = mem_printf("%s/%s", dir, list.names[i]);
		bool grey;
		double mpx = megapixels(&grey, path);
		plan->mpx += mpx;
		plan->largest_mpx = fmax(plan->largest_mpx, mpx);
		all_grey = all_grey && grey;
		free(path);
	}
	all_grey = all_grey && list.n;
	file_list_free(&list);
	free(dir);
	return all_grey;
}

static bool is_built(const char *stage)
{
	char *path = plan_stage_program(stage);
	bool built = access(path, X_OK) == 0;
	free(path);
	return built;
}

static bool runs(const struct plan *plan, const char *name)
{
	return plan->rows[plan_stage_find(name)].run;
}

static const char rests[] = "the camera rests in video/, or nothing beside the head shows that it moves: nothing tells cameras; camera.focal_px tells the lens";
static const char no_skin[] = "no mesh of the person (subject.ply), nor views/ to make it from: skin is not followed, and nothing tells how a character's moves";
static const char lids_alone[] = "learns how the lids move with the eye; no mesh of the person (subject.ply): no skin";

/* The file of video/ that is read, relative to the capture; null: none. free(). */
static char *film_of(const char *capture)
{
	struct file_list list;
	struct err none = { 0 };
	char *dir = mem_printf("%s/video", capture), *file = 0;
	if (file_list(&list, dir, &none) && list.n)
		file = mem_printf("video/%s", list.names[0]);
	file_list_free(&list);
	free(dir);
	return file;
}

/* Whether cameras are to be sought in the video alone: where its lens is not given, and unless the camera is seen to rest. */
static bool film_tells(int have, const char *capture, const char *film, const struct conf *conf)
{
	return have & HAS_VIDEO && !lens_given(conf) && (!film || plan_film_camera(capture, film) != FILM_RESTS);
}

static void measure_film(struct plan *plan, const char *film, int have)
{
	const struct film_length length = film ? plan_film_length(plan->capture, film) : (struct film_length){ 0 };
	plan->kframes = 1e-3 * length.frames;
	plan->clip_kframes = 1e-3 * length.minute * (have & HAS_SCRIPT ? 2 : 1);
}

bool plan_has_subject(const char *capture)
{
	static const char *const names[] = { "subject.ply", "subject.obj" };
	bool has = false;
	for (int i = 0; i < COUNT(names); i++) {
		char *path = mem_printf("%s/%s", capture, names[i]);
		has = has || file_exists(path);
		free(path);
	}
	return has;
}

/* The stage that lets this one run in another way with such a folder: one that runs before one that does not; null when there is none. */
static const char *other_way(const struct plan *plan, const struct plan_stage *s, int have)
{
	const char *first = 0;
	for (int i = 0; i < COUNT(s->other) && s->other[i].needs; i++)
		if ((have & s->other[i].all) == s->other[i].all) {
			if (runs(plan, s->other[i].needs))
				return s->other[i].needs;
			first = first ? first : s->other[i].needs;
		}
	return first;
}

/* The reason shown for transfer, by how many characters have the subject's topology. */
static const char *transfer_does(const char *usual, const char *capture)
{
	int all, same;
	plan_characters(&all, &same, capture);
	if (all && same == all)
		return "every character has the subject's own topology: vertex goes to vertex, no ICP";
	return same ? "fits the characters to the subject; no ICP for those of its own topology" : usual;
}

double plan_cost_seconds(const struct plan_cost *cost, const struct plan *plan)
{
	const double each[PLAN_SECONDS] = { 1, plan->mpx, plan->mtexel, plan->kframes, plan->n_characters, plan->n_characters * plan->clip_kframes };
	double sum = 0;
	for (int i = 0; i < PLAN_SECONDS; i++)
		sum += cost->seconds[i] * each[i];
	return sum;
}

bool plan_decide(struct plan *plan, const char *capture, const struct plan_cost cost[PLAN_STAGES], const struct conf *conf,
                 struct err *err)
{
	struct stat st;
	int have;
	*plan = (struct plan){ .capture = capture };
	if (stat(capture, &st) || !S_ISDIR(st.st_mode))
		return err_set(err, "%s: no such folder", capture);
	char *work = mem_printf("%s/work", capture);
	bool is_link = !lstat(work, &st) && S_ISLNK(st.st_mode);
	free(work);
	if (is_link)  // a folder from elsewhere must not choose where its results are written
		return err_set(err, "%s/work: is a link: results are written inside the capture folder alone", capture);
	if (!holdings(&have, plan, err))
		return false;
	if (!(have & (HAS_PHOTOS | HAS_VIEWS | HAS_VIDEO)) && have & HAS_TARGETS)
		return err_set(err, "%s: nothing to work on: what moves the characters of targets/ is learnt from a video: put one of the person into %s/video/",
		               capture, capture);
	if (!(have & (HAS_PHOTOS | HAS_VIEWS | HAS_VIDEO)))
		return err_set(err, "%s: nothing to work on: put macro photographs of an eye into %s/photos/", capture, capture);
	char *file = film_of(capture);
	bool grey = measure(plan), film = !(have & HAS_VIEWS) && film_tells(have, capture, file, conf);
	measure_film(plan, file, have);
	free(file);
	for (int i = 0; i < PLAN_STAGES; i++)
		plan->rows[i].name = plan_stages[i].name;
	for (int i = 0; i < PLAN_STAGES; i++) {
		const struct plan_stage *r = &plan_stages[i];
		struct plan_row *row = &plan->rows[i];
		bool calibrates = !strcmp(r->name, "calibrate"), skin = runs(plan, "calibrate") || plan_has_subject(capture);
		bool has = (!calibrates || have & HAS_VIEWS || film) && (!r->any || have & r->any) && (have & r->all) == r->all;
		const char *other = other_way(plan, r, have);
		bool fed = (has && (!r->needs || runs(plan, r->needs))) || (other && runs(plan, other));
		row->reason = r->does;
		row->told = calibrates && !has && have & HAS_VIDEO && lens_given(conf);
		plan->unbuilt |= (has || other) && !is_built(r->name);
		if (!has && !other)
			row->reason = calibrates && have & HAS_VIDEO && !row->told ? rests : r->without;
		else if (!is_built(r->name))
			row->reason = "its program is not built";
		else if (!strcmp(r->name, "transfer") && !skin)
			row->reason = no_skin;
		else if (!fed)
			row->reason = "a stage it needs does not run";
		else
			row->run = true;
		if (row->run && !strcmp(r->name, "train") && !skin)
			row->reason = lids_alone;
		if (row->run && !strcmp(r->name, "transfer"))
			row->reason = transfer_does(r->does, capture);
		if (row->run && grey && !strcmp(r->name, "pigment"))
			row->reason = "no pigments: the photographs are grey";
		row->seconds = row->run ? plan_cost_seconds(&cost[i], plan) : 0;
		row->peak_mib = row->run ? cost[i].mib[0] + cost[i].mib[1] * plan->largest_mpx : 0;
		plan->n_run += row->run && i;
	}
	return true;
}
