#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/mem.h"
#include "base/npy/npy.h"
#include "model/gaze_table.h"
#include "model/model.h"

/* The matrices: one .npy each; its shape follows from the model's counts. */
enum { M_L0, M_K, M_L, M_U0, M_J, M_M, M_L0_S, M_L_S, M_U0_S, M_M_S, M_K_S, M_J_S, M_W_S, M_RMS, M_REACH_L, M_REACH_S, M_VERTICES, MATRICES };
static const double NUMBER_MOST = 1e12;  // no coefficient of pixels, degrees and shares comes near
static const double LIDS_MOST = 100;     // of an aperture's range: a lid that hardly moves with the opening has a short one
enum { MODEL_NUMBERS = 1 << 26 };  // most numbers in a matrix; checked before any of it is read

const char *const skin_model_files[] = { "model.json",         "model_l0.npy",         "model_K.npy",
	                                     "model_L.npy",        "model_u0.npy",         "model_J.npy",
	                                     "model_M.npy",        "model_l0_sigma.npy",   "model_L_sigma.npy",
	                                     "model_u0_sigma.npy", "model_M_sigma.npy",    "model_K_sigma.npy",
	                                     "model_J_sigma.npy",  "model_W_sigma.npy",    "model_vertex_rms.npy",
	                                     "model_lid_reach.npy", "model_skin_reach.npy", "model_vertices.npy", 0 };
_Static_assert(sizeof skin_model_files / sizeof *skin_model_files == MATRICES + 2, "model.json, the matrices, null");

struct matrix {
	double **data;
	long rows, columns;  // columns 0: one dimension
};

static void matrices(struct matrix out[MATRICES], struct skin_model *m)
{
	long u = 2L * m->n_vertices, from = m->n_lid + m->n_au + 1, g = SKIN_EYE_INPUTS + 1;
	out[M_L0] = (struct matrix){ &m->l0, m->n_lid, 0 };
	out[M_K] = (struct matrix){ &m->K, m->n_lid, m->n_lid_pc };
	out[M_L] = (struct matrix){ &m->L, m->n_lid_pc, g };
	out[M_U0] = (struct matrix){ &m->u0, u, 0 };
	out[M_J] = (struct matrix){ &m->J, u, m->n_skin_pc };
	out[M_M] = (struct matrix){ &m->M, m->n_skin_pc, from };
	out[M_L0_S] = (struct matrix){ &m->l0_sigma, m->n_lid, 0 };
	out[M_L_S] = (struct matrix){ &m->L_sigma, m->n_lid_pc, g };
	out[M_U0_S] = (struct matrix){ &m->u0_sigma, u, 0 };
	out[M_M_S] = (struct matrix){ &m->M_sigma, m->n_skin_pc, from };
	out[M_K_S] = (struct matrix){ &m->K_sigma, m->n_lid, m->n_lid_pc };
	out[M_J_S] = (struct matrix){ &m->J_sigma, u, m->n_skin_pc };
	out[M_W_S] = (struct matrix){ &m->W_sigma, m->n_skin_pc, m->n_inputs + 1 };
	out[M_RMS] = (struct matrix){ &m->vertex_rms, m->n_vertices, 0 };
	out[M_REACH_L] = (struct matrix){ &m->lid_reach, SKIN_EYE_INPUTS, SKIN_EYE_INPUTS / 2 + 1 };
	out[M_REACH_S] = (struct matrix){ &m->skin_reach, m->n_inputs, m->n_inputs + 1 };
	out[M_VERTICES] = (struct matrix){ 0, m->n_vertices, 0 };
}

static json_t *inputs_json(const struct skin_model *m)
{
	json_t *inputs = json_array();
	for (int i = 0; i < m->n_inputs; i++) {
		json_t *in = json_object();
		json_object_set_new(in, "name", json_string(i < SKIN_EYE_INPUTS ? gaze_columns[i] : m->au_names[i - SKIN_EYE_INPUTS]));
		json_object_set_new(in, "low", json_number(m->low[i]));
		json_object_set_new(in, "high", json_number(m->high[i]));
		json_object_set_new(in, "mean", json_number(m->mean[i]));
		json_object_set_new(in, "rest_control", json_number(m->rest_controls[i]));
		if (i >= SKIN_EYE_INPUTS) {
			json_object_set_new(in, "lids", json_numbers(EXPRESS_LIDS, m->expression[i - SKIN_EYE_INPUTS]));
			json_object_set_new(in, "lids_sigma", json_numbers(EXPRESS_LIDS, m->expression_sigma[i - SKIN_EYE_INPUTS]));
		}
		json_array_append_new(inputs, in);
	}
	return inputs;
}

static json_t *camera_json(const struct skin_camera *c)
{
	json_t *camera = json_object();
	json_object_set_new(camera, "width", json_integer(c->width));
	json_object_set_new(camera, "height", json_integer(c->height));
	json_object_set_new(camera, "focal_px", json_number(c->focal_px));
	json_object_set_new(camera, "center_px", json_numbers(2, c->center_px));
	json_object_set_new(camera, "distortion", json_numbers(5, c->distortion));
	json_object_set_new(camera, "cam_from_head", json_numbers(16, &c->cam_from_head[0][0]));
	return camera;
}

static json_t *eyes_json(const struct skin_eyes *e)
{
	json_t *eyes = json_object();
	json_object_set_new(eyes, "center_in_head_mm", json_numbers(6, &e->center[0][0]));
	json_object_set_new(eyes, "radius_mm", json_numbers(2, e->radius));
	json_object_set_new(eyes, "limbus_radius_mm", json_numbers(2, e->limbus));
	return eyes;
}

static json_t *known_json(const struct known *k)
{
	json_t *j = json_object();
	json_object_set_new(j, "left_deg", json_numbers(2 * KNOWN_CORNERS, &k->corner[0][0][0]));
	json_object_set_new(j, "right_deg", json_numbers(2 * KNOWN_CORNERS, &k->corner[1][0][0]));
	json_object_set_new(j, "torsion_deg", json_numbers(4, &k->torsion[0][0]));
	json_object_set_new(j, "beyond", json_number(k->beyond));
	return j;
}

static json_t *model_json(const struct skin_model *m)
{
	json_t *j = json_object();
	json_object_set_new(j, "points_per_lid", json_integer(m->n_points));
	json_object_set_new(j, "vertices", json_integer(m->n_vertices));
	json_object_set_new(j, "lid_components", json_integer(m->n_lid_pc));
	json_object_set_new(j, "skin_components", json_integer(m->n_skin_pc));
	json_object_set_new(j, "reference_frame", json_integer(m->reference_frame));
	json_object_set_new(j, "inputs", inputs_json(m));
	json_object_set_new(j, "camera", camera_json(&m->camera));
	if (isfinite(m->eyes.limbus[0] + m->eyes.limbus[1]))
		json_object_set_new(j, "eyes", eyes_json(&m->eyes));
	json_object_set_new(j, "known_gazes", known_json(&m->known));
	json_object_set_new(j, "closed_px", json_numbers(SKIN_EYE_INPUTS, m->closed));
	json_object_set_new(j, "open_px", json_numbers(SKIN_EYE_INPUTS, m->open));
	json_object_set_new(j, "aperture_sigma_px", json_number(m->aperture_sigma));
	json_object_set_new(j, "baseline", json_numbers(12, &m->baseline[0][0][0]));
	json_object_set_new(j, "baseline_sigma", json_numbers(12, &m->baseline_sigma[0][0][0]));
	json_object_set_new(j, "lid_sd_px", json_numbers(m->n_lid_pc, m->lid_pc));
	json_object_set_new(j, "lid_sd_sigma_px", json_numbers(m->n_lid_pc, m->lid_pc_sigma));
	json_object_set_new(j, "skin_sd_px", json_numbers(m->n_skin_pc, m->skin_pc));
	json_object_set_new(j, "skin_sd_sigma_px", json_numbers(m->n_skin_pc, m->skin_pc_sigma));
	json_object_set_new(j, "rest_e", json_numbers(m->n_skin_pc, m->rest_e));
	return j;
}

static bool save_matrix(const struct skin_model *m, int i, const struct matrix *x, const char *path, struct err *err)
{
	if (i == M_VERTICES) {
		_Static_assert(sizeof *m->vertices == sizeof(int32_t), "rows of the mesh are int32");
		struct npy rows = npy_of(NPY_I4, 1, &x->rows, m->vertices);
		return npy_save(path, &rows, err);
	}
	struct npy array = npy_of(NPY_F8, x->columns ? 2 : 1, (long[]){ x->rows, x->columns }, *x->data);
	return npy_save(path, &array, err);
}

bool skin_model_save(const struct skin_model *m, const char *dir, const char *made_by, struct err *err)
{
	struct skin_model view = *m;
	struct matrix x[MATRICES];
	matrices(x, &view);
	bool ok = true;
	for (int i = 0; i < MATRICES && ok; i++) {
		char *path = mem_printf("%s/%s", dir, skin_model_files[i + 1]);
		ok = save_matrix(m, i, &x[i], path, err);
		free(path);
	}
	json_t *j = model_json(m);
	char *path = mem_printf("%s/%s", dir, skin_model_files[0]);
	ok = ok && json_write(path, j, made_by, err);
	json_decref(j);
	free(path);
	return ok;
}

static bool count_of(int *out, const json_t *j, const char *key, int low, int high, const char *path, struct err *err)
{
	double x;
	if (!json_get(&x, j, key, path, err))
		return false;
	if (!(x >= low && x <= high) || x != floor(x))
		return err_set(err, "%s: %s = %g: must be a whole number in [%d, %d]", path, key, x, low, high);
	*out = (int)x;
	return true;
}

/* What an expression does to lids. A model that was trained before this was told: nothing. */
static bool load_expression(double by[EXPRESS_LIDS], double sigma[EXPRESS_LIDS], const json_t *in, const char *path, struct err *err)
{
	for (int k = 0; k < EXPRESS_LIDS; k++) {
		by[k] = 0;
		sigma[k] = NAN;
	}
	if (!json_object_get(in, "lids"))
		return true;
	if (!json_get_array(by, EXPRESS_LIDS, in, "lids", path, err) || !json_get_array(sigma, EXPRESS_LIDS, in, "lids_sigma", path, err))
		return false;
	for (int k = 0; k < EXPRESS_LIDS; k++)
		if (!(fabs(by[k]) <= LIDS_MOST))
			return err_set(err, "%s: lids: %g: must be in [-%g, %g] of an eye's opening", path, by[k], LIDS_MOST, LIDS_MOST);
	return true;
}

static bool load_inputs(struct skin_model *m, const json_t *inputs, const char *path, struct err *err)
{
	for (int i = 0; i < m->n_inputs; i++) {
		const json_t *in = json_array_get(inputs, (size_t)i);
		if (!json_get(&m->low[i], in, "low", path, err) || !json_get(&m->high[i], in, "high", path, err)
		    || !json_get(&m->mean[i], in, "mean", path, err)
		    || !json_get(&m->rest_controls[i], in, "rest_control", path, err))
			return false;
		const char *name = json_get_string(in, "name", path, err);
		if (!name)
			return false;
		const int au = i - SKIN_EYE_INPUTS;
		if (au >= 0)
			m->au_names[au] = mem_str(name);
		if (au >= 0 && !load_expression(m->expression[au], m->expression_sigma[au], in, path, err))
			return false;
	}
	return true;
}

static bool load_camera(struct skin_camera *c, const json_t *camera, const char *path, struct err *err)
{
	return count_of(&c->width, camera, "width", 0, 1 << 16, path, err)
	       && count_of(&c->height, camera, "height", 0, 1 << 16, path, err)
	       && json_get(&c->focal_px, camera, "focal_px", path, err)
	       && json_get_array(c->center_px, 2, camera, "center_px", path, err)
	       && json_get_array(c->distortion, 5, camera, "distortion", path, err)
	       && json_get_array(&c->cam_from_head[0][0], 16, camera, "cam_from_head", path, err);
}

/* Models of before have none. */
static bool load_eyes(struct skin_eyes *e, const json_t *eyes, const char *path, struct err *err)
{
	if (!eyes)
		return true;
	bool ok = json_get_array(&e->center[0][0], 6, eyes, "center_in_head_mm", path, err) && json_get_array(e->radius, 2, eyes, "radius_mm", path, err)
	          && json_get_array(e->limbus, 2, eyes, "limbus_radius_mm", path, err);
	for (int s = 0; s < 2 && ok; s++)
		ok = (e->limbus[s] > 0 && e->limbus[s] < e->radius[s] && e->radius[s] < 1000)
		     || err_set(err, "%s: eyes: an iris of %g mm on an eye of %g mm", path, e->limbus[s], e->radius[s]);
	return ok;
}

static bool load_known(struct known *k, const json_t *j, const char *path, struct err *err)
{
	return json_get_array(&k->corner[0][0][0], 2 * KNOWN_CORNERS, j, "left_deg", path, err)
	       && json_get_array(&k->corner[1][0][0], 2 * KNOWN_CORNERS, j, "right_deg", path, err)
	       && json_get_array(&k->torsion[0][0], 4, j, "torsion_deg", path, err) && json_get(&k->beyond, j, "beyond", path, err)
	       && known_check(k, path, err);
}

static bool load_json(struct skin_model *m, const json_t *j, const char *path, struct err *err)
{
	const json_t *inputs = json_object_get(j, "inputs");
	int n = (int)json_array_size(inputs);
	if (n < SKIN_EYE_INPUTS || n > SKIN_EYE_INPUTS + 1000)
		return err_set(err, "%s: inputs: must be a list of %d or more", path, SKIN_EYE_INPUTS);
	m->n_au = n - SKIN_EYE_INPUTS;
	if (!count_of(&m->n_points, j, "points_per_lid", 1, 1000, path, err)
	    || !count_of(&m->n_vertices, j, "vertices", 0, 1 << 20, path, err)
	    || !count_of(&m->n_lid_pc, j, "lid_components", 0, 1000, path, err)
	    || !count_of(&m->n_skin_pc, j, "skin_components", 0, 256, path, err)
	    || !count_of(&m->reference_frame, j, "reference_frame", 0, 1 << 30, path, err))
		return false;
	if ((long)m->n_vertices * m->n_skin_pc > MODEL_NUMBERS)
		return err_set(err, "%s: vertices, skin_components: more than %d numbers", path, MODEL_NUMBERS);
	skin_model_alloc(m);
	return load_inputs(m, inputs, path, err) && load_camera(&m->camera, json_object_get(j, "camera"), path, err)
	       && load_eyes(&m->eyes, json_object_get(j, "eyes"), path, err)
	       && load_known(&m->known, json_object_get(j, "known_gazes"), path, err)
	       && json_get_array(m->closed, SKIN_EYE_INPUTS, j, "closed_px", path, err)
	       && json_get_array(m->open, SKIN_EYE_INPUTS, j, "open_px", path, err)
	       && json_get(&m->aperture_sigma, j, "aperture_sigma_px", path, err)
	       && json_get_array(&m->baseline[0][0][0], 12, j, "baseline", path, err)
	       && json_get_array(&m->baseline_sigma[0][0][0], 12, j, "baseline_sigma", path, err)
	       && json_get_array(m->lid_pc, m->n_lid_pc, j, "lid_sd_px", path, err)
	       && json_get_array(m->lid_pc_sigma, m->n_lid_pc, j, "lid_sd_sigma_px", path, err)
	       && json_get_array(m->skin_pc, m->n_skin_pc, j, "skin_sd_px", path, err)
	       && json_get_array(m->skin_pc_sigma, m->n_skin_pc, j, "skin_sd_sigma_px", path, err)
	       && json_get_array(m->rest_e, m->n_skin_pc, j, "rest_e", path, err);
}

static bool load_matrix(struct skin_model *m, int i, const struct matrix *x, const char *path, struct err *err)
{
	struct npy array;
	bool ok = npy_read(&array, path, NPY_LIMIT, err)
	          && npy_expect(&array, path, x->columns ? 2 : 1, (long[]){ x->rows, x->columns }, err)
	          && npy_in_range(&array, NUMBER_MOST, i != M_K && i != M_L && i != M_J && i != M_M, 0, path, err);
	double *data = ok ? npy_doubles(&array) : 0;
	for (long k = 0; ok && i == M_VERTICES && k < x->rows; k++) {
		ok = data[k] >= 0 && data[k] <= INT32_MAX ? true : err_set(err, "%s: a row below 0", path);
		m->vertices[k] = ok ? (int)data[k] : 0;
	}
	if (ok && i != M_VERTICES)
		memcpy(*x->data, data, (size_t)npy_count(&array) * sizeof *data);
	free(data);
	npy_free(&array);
	return ok;
}

bool skin_model_load(struct skin_model *m, const char *dir, struct err *err)
{
	*m = (struct skin_model){ 0 };
	char *path = mem_printf("%s/%s", dir, skin_model_files[0]);
	json_t *j = json_read(path, 1 << 24, err);
	bool ok = j && load_json(m, j, path, err);
	json_decref(j);
	free(path);
	struct matrix x[MATRICES];
	if (ok)
		matrices(x, m);
	for (int i = 0; i < MATRICES && ok; i++) {
		path = mem_printf("%s/%s", dir, skin_model_files[i + 1]);
		ok = load_matrix(m, i, &x[i], path, err);
		free(path);
	}
	if (!ok)
		skin_model_free(m);
	return ok;
}
