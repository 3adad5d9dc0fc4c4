#include "tests/lib/capture/track_capture.h"

#include <stdio.h>
#include <stdlib.h>

#include "base/json.h"
#include "base/mem.h"

bool track_capture_bare(const char *dir, const char *from, const char *quality, bool centers)
{
	struct err err = { 0 };
	char *conf = mem_printf("%s/capture.conf", dir), *truth = mem_printf("%s/truth.json", from);
	char *copy = mem_printf("mkdir -p '%s/video' && cp '%s/video.mp4' '%s/video/' && cp '%s/subject.ply' '%s/' && chmod -R u+w '%s'", dir, from, dir, from, dir, dir);
	json_t *j = json_read(truth, 1 << 24, &err), *row;
	const json_t *K = json_object_get(j, "K"), *x = json_array_get(K, 0), *y = json_array_get(K, 1);
	FILE *out = j && !system(copy) ? fopen(conf, "w") : 0;
	const char *mark;
	if (out) {
		fprintf(out, "camera.focal_px = %.6g\ncamera.center_px = %g %g\nsubject.unit_mm = 10\nquality = %s\n", json_number_value(json_array_get(x, 0)),
		        json_number_value(json_array_get(x, 2)), json_number_value(json_array_get(y, 2)), quality);
		json_object_foreach(json_object_get(j, "landmarks_skin_vertex"), mark, row)
			fprintf(out, "subject.landmark.%s = %lld\n", mark, (long long)json_integer_value(row));
		json_object_foreach(centers ? json_object_get(j, "eye_centre_head_cm") : 0, mark, row)
			fprintf(out, "subject.eye_center.%s = %.4f %.4f %.4f\n", mark, json_number_value(json_array_get(row, 0)), json_number_value(json_array_get(row, 1)),
			        json_number_value(json_array_get(row, 2)));
		if (centers)
			fprintf(out, "subject.eye_radius = %.4f\n", json_number_value(json_object_get(j, "eye_radius_cm")));
		fclose(out);
	}
	json_decref(j);
	free(conf);
	free(truth);
	free(copy);
	return out;
}
