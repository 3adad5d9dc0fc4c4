/* What all pictures of a character are made from: eyes, light, the trained model, its rig. Made when the first picture needs it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "draw/eye/seen.h"
#include "export/outside.h"
#include "math/vec.h"
#include "render/face/skin.h"

/* Gain of the beauty views' light for skin: a face comes out as in a portrait. */
static const double exposure = 0.95;

static bool light_ready(struct skin_job *job, struct err *err)
{
	struct job studio = { .stage = job->stage, .conf = job->render };
	bool ok = job_studio(&studio, err);
	job->studio = studio.studio;
	job->gain = exposure;
	return ok;
}

/* An eye that no photograph was fitted to: the film's as far as it shows one. */
static bool invent(struct skin_job *job, struct err *err)
{
	struct eye eye = *job->eye;
	struct scene_conf conf = job->render->scene;
	struct scene_seen seen;
	bool found;
	eye.limbus_aspect = isfinite(eye.limbus_aspect) ? eye.limbus_aspect : 0.95;
	conf.limbus_width = isfinite(conf.limbus_width) ? conf.limbus_width : 0.5;
	if (!skin_iris_of_film(&seen, &found, job, err))
		return false;
	scene_plain(&job->plain, &eye, &conf, job->conf->iris_rgb, (uint64_t)conf.seed, found ? &seen : 0);
	if (found)
		scene_seen_free(&seen);
	struct scene_view view = scene_view_turned(&job->plain, 0, 0, job->render->field_mm, 256);
	struct scene_lighting light = scene_lighting(&job->studio, 0, job->render->lights);
	scene_fit_colour(&job->plain, &view, &light);
	return true;
}

/* Assigns fitted eyes to their sides; a single or unnamed one to both. Without any an eye is invented. */
static bool eyes_ready(struct skin_job *job, struct err *err)
{
	for (int i = 0, n = 0; i < job->photographed->n && n < 2; i++) {
		struct job *eye = &job->photographed->job[i];
		if (!eye->usable)
			continue;
		n++;
		if (!job_ready(eye, err))
			return false;
		int side = !strcmp(eye->names->side, "right");
		job->eyes[side] = &eye->scene;
		if (!job->eyes[!side])
			job->eyes[!side] = &eye->scene;
	}
	if (job->eyes[0])
		return true;
	if (!invent(job, err))
		return false;
	job->eyes[0] = job->eyes[1] = &job->plain;
	return true;
}

bool skin_ready(struct skin_job *job, struct err *err)
{
	job->ready = job->ready || (light_ready(job, err) && eyes_ready(job, err)
	                            && skin_model_load(&job->model, stage_path(job->stage, "work/skin"), err)
	                            && wrinkle_maps_load(&job->wrinkles, stage_path(job->stage, "work/skin"), err));
	return job->ready;
}

/* Whether the look's faces are the rig's, and its blend shapes move vertices of it. */
static bool fits(const struct look *look, const struct rig *rig)
{
	bool same = look->n_faces == rig_own_faces(rig) && look->n_points <= rig_own_vertices(rig);
	for (int f = 0; same && f < look->n_faces; f++)
		for (int k = 0; k < 3; k++)
			same = same && look->point[look->corner[f][k]] == rig->faces[f][k];
	for (int i = 0; same && i < look->shape_start[look->n_shapes]; i++)
		same = look->shape_point[i] < rig_own_vertices(rig);
	return same;
}

/* Reads the character's own look. */
static bool dress(struct skin_job *job, struct skin_target *t, struct err *err)
{
	const char *path = stage_path(job->stage, "%s", t->look_path);
	struct err why = { 0 };
	if (!look_load(&t->look, path, err))
		return false;
	if (!fits(&t->look, &t->rig))
		return err_set(err, "%s: its faces are not the rig's: run transfer again", path);
	t->dress = dress_new(&t->look, job->conf->texture_px, &why);
	if (err_is(&why))
		stage_skipped(job->stage, "%s: a texture %s", t->name, why.msg);
	return true;
}

/* Whether a texture of its own colours the character: brows are painted there. */
static bool coloured(const struct skin_target *t)
{
	for (int i = 0; t->look_path && i < t->look.n_materials; i++)
		if (t->look.material[i].map[LOOK_COLOUR] >= 0)
			return true;
	return false;
}

struct portrait_conf skin_portrait(const struct skin_job *job, const struct skin_target *t)
{
	struct portrait_conf conf = job->conf->portrait;
	conf.dress = t->dress;
	if ((t->film || t->views) && t->dress && !t->look_path)
		memcpy(conf.skin_rgb, t->film_rgb, sizeof conf.skin_rgb);
	if (coloured(t))
		conf.hair.brow_mm = 0;
	if (job->conf->hair == HAIR_AVERAGE || !t->film_hair)
		return conf;
	conf.hair.film = t->film_hair;
	conf.hair.place = (const float(*)[3])t->film_place;
	return conf;
}

bool skin_open(struct skin_job *job, struct skin_target *t, struct err *err)
{
	if (t->portrait)
		return true;
	if (!skin_ready(job, err) || !rig_load(&t->rig, stage_path(job->stage, "%s", t->rig_path), err))
		return false;
	if (t->rig.n_inputs != job->model.n_inputs)
		return err_set(err, "%s: %d inputs, but work/skin/model.json has %d: run extrapolate again", t->rig_path, t->rig.n_inputs,
		               job->model.n_inputs);
	if (t->look_path ? !dress(job, t, err) : (t->film || t->views) && !skin_of_film(job, t, err))
		return false;
	const struct portrait_conf conf = skin_portrait(job, t);
	t->portrait = portrait_new(&t->rig, job->eyes, &job->studio, &conf);
	portrait_wear(t->portrait, &job->wrinkles, job->model.n_au, job->model.au_names);
	return true;
}

void skin_free(struct skin_target *t)
{
	portrait_free(t->portrait);
	dress_free(t->dress);
	look_free(&t->look);
	free(t->film_hair);
	free(t->film_place);
	rig_free(&t->rig);
}

double skin_over_globe(const struct scene *eye, const struct rig_globe *globe)
{
	enum { RINGS = 48, AROUND = 32 };
	const double scale = globe->radius / eye->conf.sclera_radius;
	double worst = -INFINITY;
	for (int j = 0; j < RINGS; j++)
		for (int i = 0; i < AROUND; i++) {
			double r = eye->conf.sclera_radius * sin(M_PI / 3) * j / RINGS, turn = 2 * M_PI * i / AROUND, at[3];
			export_front(at, eye, r * cos(turn), r * sin(turn));
			const double d[3] = { at[0], -at[1], eye->sclera_z - at[2] };
			worst = fmax(worst, scale * vec_norm(d) - (double)globe_map_at(&globe->map, (float[3]){ (float)d[0], (float)d[1], (float)d[2] }));
		}
	return worst;
}

void skin_close(struct skin_job *job)
{
	if (job->eyes[0] == &job->plain)
		scene_free(&job->plain);
	if (job->eye_glb[1] != job->eye_glb[0])
		free(job->eye_glb[1]);
	free(job->eye_glb[0]);
	free(job->worn.name);
	look_free(&job->worn.look);
	free(job->worn.hair);
	free(job->worn.place);
	envmap_free(&job->studio);
	skin_model_free(&job->model);
	wrinkle_maps_free(&job->wrinkles);
}
