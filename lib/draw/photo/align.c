/* A photograph's place in the merged maps. A pose does not contain the eye's torsion: the eye frame of each photograph follows its
 * own camera. unrefract found the torsion, and a small affine rest, by registering the textures.
 */
#include <math.h>
#include <string.h>

#include "base/file.h"
#include "base/json.h"
#include "draw/photo/lids.h"

enum { TEXTURE_JSON_LIMIT = 1 << 22 };

struct scene_view shot_view(const struct shot *shot)
{
	struct scene_view view = scene_view_photo(&shot->fit, shot->window, shot->scale);
	memcpy(view.slip, shot->slip, sizeof view.slip);
	return view;
}

double ellipse_radius(const struct ellipse *e, double x, double y)
{
	double c = cos(e->angle), s = sin(e->angle), dx = x - e->cx, dy = y - e->cy;
	double u = (c * dx + s * dy) / e->a, v = (c * dy - s * dx) / e->b;
	return sqrt(u * u + v * v);
}

/* m: photo_from_map, [2][3]. With m = turn · rest, the turn goes into the pose and the inverse of the rest is the slip. */
static bool align(struct shot *shot, const double m[6])
{
	double turn = atan2(m[3] - m[1], m[0] + m[4]), c = cos(turn), s = sin(turn);
	double rest[2][3];
	for (int j = 0; j < 3; j++) {
		rest[0][j] = c * m[j] + s * m[3 + j];
		rest[1][j] = c * m[3 + j] - s * m[j];
	}
	double det = rest[0][0] * rest[1][1] - rest[0][1] * rest[1][0];
	if (!(fabs(det) > 0.1 && fabs(det) < 10))
		return false;
	double inverse[2][2] = { { rest[1][1] / det, -rest[0][1] / det }, { -rest[1][0] / det, rest[0][0] / det } };
	for (int i = 0; i < 2; i++) {
		for (int j = 0; j < 2; j++)
			shot->slip[i][j] = inverse[i][j] - (i == j);
		shot->slip[i][2] = -inverse[i][0] * rest[0][2] - inverse[i][1] * rest[1][2];
	}
	for (int i = 0; i < 3; i++) {
		double *row = shot->fit.cam_from_eye[i], x = row[0], y = row[1];
		row[0] = c * x + s * y;
		row[1] = c * y - s * x;
	}
	return true;
}

bool shot_align(struct shot *shot, const char *texture_json, struct err *err)
{
	if (!file_exists(texture_json))
		return true;
	json_t *json = json_read(texture_json, TEXTURE_JSON_LIMIT, err), *entry;
	bool ok = json;
	size_t i;
	json_array_foreach(json_object_get(json, "photos"), i, entry) {
		const char *name = json_string_value(json_object_get(entry, "name"));
		double m[6];
		if (!ok || !name || strcmp(name, shot->photo->name) || !json_object_get(entry, "photo_from_map"))
			continue;
		ok = shot_lids_read(shot, entry, texture_json, err) && json_get_array(m, 6, entry, "photo_from_map", texture_json, err)
		     && (align(shot, m) || err_set(err, "%s: photo_from_map of %s: must be near a turn", texture_json, name));
	}
	json_decref(json);
	return ok;
}
