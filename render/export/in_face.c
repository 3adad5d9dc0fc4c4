/* The eye of a driven face's file, in memory. */
#include <string.h>

#include "render/export/export.h"

bool export_in_face(char **out, size_t *size, const struct scene *scene, const struct envmap *lit, const struct export_conf *conf, struct err *err)
{
	struct export_work w = { .conf = conf };
	bool ok = export_eye_maps(w.maps, scene, 0, lit, conf->face_px, err) && export_encode(&w, err);
	*out = 0;
	if (ok) {
		long all = 0;
		double error_mm;
		struct export_part less[EXPORT_PARTS];
		export_eye_meshes(w.parts, scene, &conf->mesh);
		for (int i = 0; i < EXPORT_PARTS; i++)
			all += w.parts[i].n_corners / 3;
		export_fewer(less, &error_mm, scene, &conf->mesh, all, conf->lod_triangles[0]);
		ok = export_eye_pack(out, size, &(struct export_eye){ less, w.pictures, scene->cornea.n, w.high[EXPORT_CORNEA_DEPTH], "eye", 0, 2 * scene->pupil[2], 0, { 0 } }, err);
		for (int i = 0; i < EXPORT_PARTS; i++)
			export_part_free(&less[i]);
	}
	export_work_free(&w);
	return ok;
}
