#include "render/face/skin_tracked.h"

#include <math.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "bridge/om_mesh.h"
#include "math/vec.h"

const char *const tracked_files[TRACKED_FILES] = { "work/skin/track.json", "work/skin/head.npy", "work/skin/skin.npy", "work/skin/vertices.npy",
	                                               "work/skin/confidence.npy", "work/skin/lids.npy" };

void tracked_free(struct tracked *f)
{
	npy_free(&f->head);
	npy_free(&f->skin);
	npy_free(&f->vertices);
	npy_free(&f->sure);
	npy_free(&f->lids);
	mesh_free(&f->mesh);
}

static bool read_track(struct tracked *f, const char *path, struct err *err)
{
	static const char *const eyes[2] = { "left_eye", "right_eye" };
	json_t *j = json_read(path, 1 << 24, err);
	const json_t *camera = json_object_get(j, "camera");
	double width = 0, height = 0, reference = 0, *radius = f->eye_radius;
	bool ok = j && json_get(&width, camera, "width", path, err) && json_get(&height, camera, "height", path, err)
	          && json_get(&f->camera.focal_px, camera, "focal_px", path, err) && json_get_array(f->camera.center_px, 2, camera, "center_px", path, err)
	          && json_get_array(f->camera.distortion, 5, camera, "distortion", path, err) && json_get(&reference, j, "reference_frame", path, err);
	for (int s = 0; s < 2 && ok; s++) {
		const json_t *eye = json_object_get(j, eyes[s]);
		if (!json_is_object(eye))
			ok = err_set(err, "one eye alone was followed");
		ok = ok && json_get_array(f->eye[s], 3, eye, "center_in_head_mm", path, err) && json_get(&radius[s], eye, "radius_mm", path, err)
		     && json_get(&f->limbus[s], eye, "limbus_radius_mm", path, err);
	}
	f->radius = 0.5 * (radius[0] + radius[1]);
	double apart[3];
	vec_add(apart, f->eye[0], -1, f->eye[1]);
	for (int s = 0; s < 2; s++)
		ok = ok && ((f->limbus[s] > 1 && f->limbus[s] < radius[s]) || err_set(err, "%s: an iris of %g mm on an eye of %g mm", path, f->limbus[s], radius[s]));
	ok = ok && ((f->radius > 1 && f->radius < 100 && vec_norm(apart) > f->radius && vec_norm(apart) < 1000 && width >= 16 && height >= 16 && width < 20000
	             && height < 20000 && f->camera.focal_px > 1 && reference >= 0 && reference < 1e7)
	            || err_set(err, "%s: no picture of two eyes", path));
	f->width = ok ? (int)width : 0;
	f->height = ok ? (int)height : 0;
	f->reference = ok ? (int)reference : 0;
	json_decref(j);
	return ok;
}

static bool read_array(struct npy *out, struct skin_job *job, int file, enum npy_type type, int ndim, const long *shape, struct err *err)
{
	const char *path = stage_path(job->stage, "%s", tracked_files[file]);
	if (!npy_read(out, path, NPY_LIMIT, err) || !npy_expect(out, path, ndim, shape, err))
		return false;
	return out->type == type || err_set(err, "%s: other types of numbers than track writes: run it again", path);
}

bool tracked_load_eyes(struct tracked *f, struct skin_job *job, struct err *err)
{
	*f = (struct tracked){ 0 };
	bool ok = read_track(f, stage_path(job->stage, "%s", tracked_files[TRACKED_JSON]), err) && read_array(&f->head, job, TRACKED_HEAD, NPY_F8, 3, (long[]){ -1, 4, 4 }, err);
	f->frames = ok ? f->head.shape[0] : 0;
	ok = ok && read_array(&f->lids, job, TRACKED_LIDS, NPY_F4, 4, (long[]){ f->frames, TRACKED_MARGINS, -1, 2 }, err);
	if (ok && (f->reference >= f->frames || f->lids.shape[2] < 2))
		return err_set(err, "%s: not of the video's frames: run track again", tracked_files[f->reference >= f->frames ? TRACKED_HEAD : TRACKED_LIDS]);
	return ok;
}

bool tracked_load_mesh(struct tracked *f, struct skin_job *job, const struct skin_target *t, struct err *err)
{
	double unit = 1;
	const char *laid = stage_path(job->stage, "work/targets/%s/registration.json", t->name);
	json_t *j = json_read(laid, 1 << 24, err);
	const bool ok = j && json_get(&unit, j, "subject_unit_mm", laid, err) && om_mesh_load(&f->mesh, stage_path(job->stage, "%s", t->subject), 10000000, err);
	json_decref(j);
	for (int i = 0; i < f->mesh.n_vertices; i++)
		for (int k = 0; k < 3; k++)
			f->mesh.vertices[i][k] *= (float)unit;
	return ok;
}

bool tracked_load(struct tracked *f, struct skin_job *job, const struct skin_target *t, struct err *err)
{
	bool ok = tracked_load_eyes(f, job, err) && tracked_load_mesh(f, job, t, err) && read_array(&f->vertices, job, TRACKED_VERTICES, NPY_I4, 1, (long[]){ -1 }, err)
	          && read_array(&f->skin, job, TRACKED_SKIN, NPY_F4, 3, (long[]){ f->frames, f->vertices.shape[0], 2 }, err)
	          && read_array(&f->sure, job, TRACKED_CONFIDENCE, NPY_F4, 2, (long[]){ f->frames, f->vertices.shape[0] }, err);
	const int32_t *row = f->vertices.data;
	for (long i = 0; i < (ok ? f->vertices.shape[0] : 0); i++)
		if (row[i] < 0 || row[i] >= f->mesh.n_vertices)
			return err_set(err, "%s: vertex %d is no row of %s: run track again", tracked_files[TRACKED_VERTICES], row[i], t->subject);
	return ok;
}

const double (*tracked_pose(const struct tracked *f, long frame))[4]
{
	return (const double(*)[4])((const double *)f->head.data + 16 * frame);
}

void tracked_mark_open(uint8_t *open, int width, int height, const float (*lids)[2], long m, const double further[2])
{
	memset(open, 0, (size_t)width * (size_t)height);
	for (int s = 0; s < 2; s++) {
		const float (*up)[2] = lids + 2 * s * m, (*low)[2] = up + m;
		for (long i = 0; i + 1 < m; i++)
			for (int part = 0; part < 16; part++) {
				const float t = ((float)part + 0.5f) / 16;
				const double x = (double)(up[i][0] + t * (up[i + 1][0] - up[i][0])), x2 = (double)(low[i][0] + t * (low[i + 1][0] - low[i][0]));
				const double y = (double)(up[i][1] + t * (up[i + 1][1] - up[i][1])) - further[1], y2 = (double)(low[i][1] + t * (low[i + 1][1] - low[i][1])) + further[1];
				const double left = fmin(x, x2) - further[0], right = fmax(x, x2) + further[0];
				if (!(left < width && right > 0 && y < height && y2 > 0))
					continue;
				for (int v = (int)fmax(y, 0); v <= (int)fmin(y2, height - 1); v++)
					for (int u = (int)fmax(left, 0); u <= (int)fmin(right, width - 1); u++)
						open[(long)v * width + u] = 1;
			}
	}
}

bool tracked_decode(int n, const long *frame, const struct tracked *f, struct skin_job *job, const char *path, const struct tracked_take *take, struct err *err)
{
	long last = 0;
	struct video_info info;
	struct video *video = video_open(&info, path, &job->conf->video, err);
	bool ok = video, got = n > 0;
	if (ok && (info.width != f->width || info.height != f->height))
		ok = err_set(err, "the video is not the one that was followed");
	for (int i = 0; i < n; i++)
		last = frame[i] > last ? frame[i] : last;
	while (ok && got) {
		struct video_frame v;
		ok = video_next(&v, &got, video, err);
		if (!ok || !got)
			break;
		for (int i = 0; i < n; i++)
			if (frame[i] == v.index) {
				uint8_t *rgb = mem_array(3 * (size_t)f->width * (size_t)f->height + 1, 1);
				video_frame_rgb(rgb, 3 * f->width, &v, 0, 0, f->width, f->height);
				take->take(take->to, i, rgb);
			}
		got = v.index < last;
		video_frame_free(&v);
	}
	video_close(video);
	return ok;
}
