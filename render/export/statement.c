/* eye.json: what is in the export, in which units, and what a program that draws triangles loses of the fitted eye. */
#include <math.h>

#include "base/json.h"
#include "base/mem.h"
#include "draw/eye/look.h"
#include "draw/eye/sclera.h"
#include "render/export/export.h"

static json_t *textures(const struct export_work *w)
{
	json_t *out = json_object();
	for (int i = 0; i < EXPORT_MAPS; i++) {
		const struct image *m = &w->maps[i];
		bool iris = i <= EXPORT_IRIS_FRECKLES, cornea = i >= EXPORT_CORNEA_COLOUR;
		json_t *entry = json_pack("{s:i,s:i}", "px", m->width, "channels", m->channels);
		if (iris || cornea) {
			json_object_set_new(entry, "mapping", json_string("planar: x, y of the eye"));
			json_object_set_new(entry, "half_width_mm", json_real(iris ? export_iris_extent(&w->job->scene) : export_cornea_extent(&w->job->scene)));
		} else {
			json_object_set_new(entry, "mapping", json_string("azimuthal equidistant about the eye's axis"));
			json_object_set_new(entry, "half_width_deg", json_real(SCENE_SCLERA_REACH * 180 / M_PI));
		}
		if (w->low[i] != 0 || w->high[i] != 1) {
			json_object_set_new(entry, "png_black", json_real(w->low[i]));
			json_object_set_new(entry, "png_white", json_real(w->high[i]));
		}
		json_object_set_new(out, export_map_names[i], entry);
	}
	return out;
}

static json_t *losses(const struct export_work *w)
{
	json_t *out = json_array();
	for (int i = 0; i < EXPORT_VIEWS; i++) {
		const struct export_loss *l = &w->loss[i];
		json_array_append_new(out, json_pack("{s:f,s:f,s:f,s:f,s:f,s:f}", "deg", l->deg, "refraction_mm_mean", l->mm_mean, "refraction_mm_most",
		                                     l->mm_most, "iris_difference_mean", l->de_mean, "iris_difference_95", l->de_95, "eye_difference_mean", l->de_eye));
	}
	return out;
}

static json_t *files(const struct export_work *w)
{
	static const char *const names[] = { "eye.glb", "eye_lod1.glb", "eye_lod2.glb" };
	json_t *out = json_array();
	for (int i = 0; i <= EXPORT_LODS; i++)
		json_array_append_new(out, json_pack("{s:s,s:I,s:i,s:i,s:f}", "file", names[i], "bytes", (json_int_t)w->bytes[i], "triangles",
		                                     w->triangles[i], "vertices", w->vertices[i], "surface_error_mm", w->error_mm[i]));
	return out;
}

/* The camera of reference_*.exr, in glTF's frame (draw/eye/view.c), and the light. */
static json_t *reference(const struct export_work *w)
{
	const struct scene *s = &w->job->scene;
	struct scene_view v = scene_view_turned(s, 0, 0, w->job->conf->field_mm, w->reference[0].width);
	return json_pack("{s:i,s:f,s:f,s:s,s:s,s:f}", "px", v.width, "camera_z_mm", v.cam_from_eye[2][3] + s->sclera_z, "field_of_view_deg",
	                 2 * atan(0.5 * v.width / v.camera.focal_px) * 180 / M_PI, "turn", "the eye about +y by the file's degrees", "light",
	                 "studio.exr: the middle is +z, right is +x, top is +y", "exposure", w->job->gain);
}

/* Numbers as the engines' eye shaders want them: shares of the eyeball's diameter, of the limbus' radius, of a planar map of the front.
 * engines.md says what each is for. */
static json_t *engine(const struct export_work *w)
{
	const struct scene *s = &w->job->scene;
	const struct image *rough = &w->maps[EXPORT_SCLERA_ROUGHNESS];
	const double limbus = s->limbus[0], ball = 2 * s->conf.sclera_radius, behind = s->eye.iris_depth - s->limbus_depth;
	const double roughness = *image_at(rough, rough->width - 1, rough->height / 2);  // furthest from the limbus
	const struct { const char *name; double value; } numbers[] = {
		{ "limbus_in_unit", limbus / ball },
		{ "limbus_aspect", s->limbus[1] / limbus },
		{ "center_in_unit", (s->sclera_z - s->limbus_depth) / ball },
		{ "iris_in_unit", behind / ball },
		{ "iris_crop", limbus / export_iris_extent(s) },
		{ "pupil_in_iris", s->pupil[2] / limbus },
		{ "pupil_least", 0.5 * export_pupils[0] / limbus },
		{ "pupil_most", 0.5 * export_pupils[1] / limbus },
		{ "limbal_ring", 0.5 * s->conf.limbus_width / limbus },
		{ "iris_uv_radius", limbus / ball },
		{ "depth_over_limbus", behind / limbus },
		{ "depth_mm", behind },
		{ "sclera_reach", SCENE_SCLERA_REACH },
		{ "sclera_rough", roughness },
		{ "sclera_smoothness", 1 - roughness },
	};
	json_t *out = json_object();
	for (int i = 0; i < COUNT(numbers); i++)
		json_object_set_new(out, numbers[i].name, json_real(numbers[i].value));
	return out;
}

json_t *export_statement(const struct export_work *w)
{
	const struct scene *s = &w->job->scene;
	json_t *out = json_object();
	json_object_set_new(out, "side", json_string(w->job->names->side));
	json_object_set_new(out, "frame", json_string("glTF: metres, y up, the eye looks along +z, origin at the centre of the scleral sphere; x is the camera's"));
	json_object_set_new(out, "cornea", json_pack("{s:f,s:f,s:f,s:f}", "radius_mm", s->cornea.R, "asphericity", s->cornea.p, "index", s->cornea.n,
	                                             "apex_from_origin_mm", s->sclera_z));
	json_object_set_new(out, "tear_film", json_pack("{s:f,s:s,s:b}", "index", LOOK_FILM_INDEX, "roughness", "textures/cornea_roughness, textures/sclera_roughness", "meniscus",
	                                                w->has_margin && w->margin[EXPORT_TEARS].n_corners));
	json_object_set_new(out, "limbus_mm", json_pack("[f,f]", s->limbus[0], s->limbus[1]));
	json_object_set_new(out, "limbus_width_mm", json_real(s->conf.limbus_width));
	json_object_set_new(out, "sclera_radius_mm", json_real(s->conf.sclera_radius));
	json_object_set_new(out, "iris", json_pack("{s:f,s:f,s:f,s:f}", "normal_scale", export_normal_scale, "depth_behind_apex_mm", s->eye.iris_depth, "pupil_diameter_mm", 2 * s->pupil[2],
	                                           "root_radius_mm", export_iris_root(s)));
	json_object_set_new(out, "reference", reference(w));
	json_object_set_new(out, "files", files(w));
	json_object_set_new(out, "textures", textures(w));
	json_object_set_new(out, "iris_map", json_pack("{s:f}", "half_width_mm", export_iris_extent(s)));
	json_object_set_new(out, "engine", engine(w));
	json_object_set_new(out, "lost", losses(w));
	json_object_set_new(out, "lost_means", json_string("a rasteriser as three.js is against render's own picture in its studio, the eye turned by deg: distance on the "
	                                                   "iris plane between what a pixel shows and ought to show; CIEDE2000 over the iris and over the eye"));
	json_object_set_new(out, "left_out", s->eye.two_surface ? json_string("the posterior surface of the cornea, one surface of the index given refracts; the ripples of the tear film: textures/sclera_normal")
	                                                        : json_string("the ripples of the tear film: textures/sclera_normal, for a shader whose film has a normal of its own"));
	return out;
}
