#include "tests/lib/capture/track_capture.h"

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/file.h"
#include "base/json.h"
#include "base/mem.h"
#include "tests/lib/bench/bench.h"
#include "tests/lib/score/track_units.h"
#include "tests/lib/variants/worsen.h"

static double now(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

bool track_capture_make(const char *dir, const char *clip, const char *quality, const char *how, int n, const char *const units[])
{
	struct err err = { 0 };
	double c[2][3], radius;
	char *from = mem_printf("video/%s", clip), *conf = mem_printf("%s/capture.conf", dir), *json = mem_printf("%s/truth.json", bench_data(from));
	char *copy = mem_printf("mkdir -p '%s/video' && cp '%s/video.mp4' '%s/video/' && cp '%s/subject.ply' '%s/' && chmod -R u+w '%s'", dir, bench_data(from),
	                        dir, bench_data(from), dir, dir);
	char *video = mem_printf("%s/video/video.mp4", dir), *source = mem_printf("%s/video.mp4", bench_data(from));
	double scale = how && !strcmp(how, "half") ? 0.5 : 1;
	json_t *j = json_read(json, 1 << 24, &err);
	const json_t *eyes = json_object_get(j, "eye_centre_head_cm"), *K = json_array_get(json_object_get(j, "K"), 0);
	bool ok = j && !system(copy) && json_get_array(c[0], 3, eyes, "left", json, &err) && json_get_array(c[1], 3, eyes, "right", json, &err)
	          && json_get(&radius, j, "eye_radius_cm", json, &err);
	ok = ok && (!how || worsen_video(video, source, how, &err));
	FILE *out = ok ? fopen(conf, "w") : 0;
	if (out) {
		fprintf(out, "camera.focal_px = %g\ncamera.center_px = %g %g\nsubject.unit_mm = 10\nsubject.eye_radius = %.4f\nquality = %s\n",
		        scale * json_number_value(json_array_get(K, 0)), scale * 640, scale * 360, radius, quality);
		for (int e = 0; e < 2; e++)
			fprintf(out, "subject.eye_center.%s = %.4f %.4f %.4f\n", e ? "right" : "left", c[e][0], c[e][1], c[e][2]);
		const char *mark;
		json_t *row, *marks = json_object_get(j, "landmarks_skin_vertex");
		json_object_foreach(marks, mark, row)
			if (strstr(mark, "canthus"))
				fprintf(out, "subject.landmark.%s = %lld\n", mark, (long long)json_integer_value(row));
		// where the time of every frame counts nothing is looked for that nobody asked for
		for (int k = 0, frame[2]; k < n && !strcmp(quality, "review"); k++)
			if (track_units_mark(frame, bench_data(from), units[k]))
				fprintf(out, "expression.%s = %d %d\n", units[k], frame[0], frame[1]);
		fclose(out);
	}
	json_decref(j);
	free(from);
	free(conf);
	free(json);
	free(copy);
	free(video);
	free(source);
	return out;
}

double track_capture_run(const char *dir)
{
	char *capture = mem_printf("--capture=%s", dir);
	double start = now();
	fflush(stdout);
	pid_t pid = fork();
	if (!pid) {
		execl("bin/track", "track", "--quiet", "--force", capture, (char *)0);
		_exit(127);
	}
	int status = 1;
	waitpid(pid, &status, 0);
	free(capture);
	return WIFEXITED(status) && !WEXITSTATUS(status) ? now() - start : NAN;
}

static int is_clip(const struct dirent *d)
{
	char *path = mem_printf("%s/%s/video.mp4", getenv("EYEWRIGHT_FACES"), d->d_name);
	const char *part = getenv("FACES");
	bool is = d->d_name[0] != '.' && file_exists(path) && (!part || strstr(d->d_name, part));
	free(path);
	return is;
}

int track_capture_faces(char *name[TRACK_FACES])
{
	struct dirent **list = 0;
	const int n = getenv("EYEWRIGHT_FACES") ? scandir(getenv("EYEWRIGHT_FACES"), &list, is_clip, alphasort) : 0;
	for (int i = 0; i < n; i++) {
		if (i < TRACK_FACES)
			name[i] = mem_str(list[i]->d_name);
		free(list[i]);
	}
	free(list);
	return n < 0 ? 0 : n < TRACK_FACES ? n : TRACK_FACES;
}
