#include "limbus/record.h"

#include <math.h>
#include <string.h>

#include "base/json.h"

enum { FILE_LIMIT = 1 << 20 };

void limbus_record_fill(struct limbus_record *record, const struct limbus_found *found, const struct photo *photo)
{
	*record = (struct limbus_record){ .ok = found->ok, .by_hand = found->by_hand, .rough = found->rough, .width = photo->width, .height = photo->height };
	memcpy(record->reason, found->reason, sizeof record->reason);
	record->gross = found->by_hand ? 0 : fmax(found->posterior.gross, found->posterior.beyond_right);
	record->has_guess = found->limbus.e.a > 0;
	record->guess = found->limbus.e;
	record->has_rival = found->posterior.rival >= 0 && !found->by_hand;
	record->rival = found->posterior.other;
	if (!limbus_usable(found))
		return;
	const struct rim *rim = &found->limbus;
	record->view.limbus = rim->e;
	memcpy(record->view.cov_q, rim->cov_q, sizeof rim->cov_q);
	memcpy(record->view.reach, found->reach, sizeof found->reach);
	record->view.has_pupil = found->has_pupil;
	if (found->has_pupil) {
		record->view.pupil = found->pupil.e;
		record->view.pupil_sigma = sqrt((found->pupil.cov_q[0][0] + found->pupil.cov_q[1][1]) / 2);
	}
	/* widths lie at equal steps along the curve: moved to equal steps of the eccentric angle, nearest */
	for (int i = 0, k = 0; i < POSE_RAMP; i++) {
		double t = 2 * M_PI * i / POSE_RAMP;
		while (k + 1 < ARCS && fabs(rim->t[k + 1] - t) <= fabs(rim->t[k] - t))
			k++;
		record->view.ramp[i] = rim->used[k] ? rim->own_width[k] : 0;
	}
	record->coverage = rim->coverage;
	record->share_used = rim->share_used;
	record->rms = rim->rms;
	record->blur = rim->width;
	record->contrast = rim->contrast;
	for (int i = 0; i < ARCS; i++) {
		record->state[i] = rim->used[i] ? ARC_USED : rim->seen[i] ? ARC_SEEN : ARC_HIDDEN;
		/* where no step was measured, the point lies on the ellipse */
		double n[2];
		if (rim->used[i])
			memcpy(record->point[i], rim->p[i], sizeof rim->p[i]);
		else
			ellipse_point(record->point[i], n, &rim->e, rim->t[i]);
	}
}

static json_t *ellipse_json(const struct ellipse *e)
{
	double v[5] = { e->cx, e->cy, e->a, e->b, e->angle };
	return json_numbers(5, v);
}

bool limbus_record_save(const struct limbus_record *r, const char *path, const char *made_by, struct err *err)
{
	json_t *json = json_object();
	json_object_set_new(json, "status", json_string(r->ok ? "ok" : "rejected"));
	json_object_set_new(json, "reason", json_string(r->reason));
	double size[2] = { r->width, r->height };
	json_object_set_new(json, "size_px", json_numbers(2, size));
	json_object_set_new(json, "gross_probability", json_number(r->gross));
	if (r->has_guess)
		json_object_set_new(json, "guess", ellipse_json(&r->guess));
	if (r->has_rival)
		json_object_set_new(json, "rival", ellipse_json(&r->rival));
	if (r->rough > 0)
		json_object_set_new(json, "rough", json_number(r->rough));
	if (r->ok || r->rough > 0) {
		const struct camera *c = &r->view.camera;
		double camera[9] = { c->focal_px, c->center_px[0], c->center_px[1], c->distortion[0], c->distortion[1],
			             c->distortion[2], c->distortion[3], c->distortion[4], c->source };
		double measured[6] = { r->coverage, r->share_used, r->rms, r->blur, r->contrast, r->view.pupil_sigma };
		double state[ARCS];
		for (int i = 0; i < ARCS; i++)
			state[i] = r->state[i];
		json_object_set_new(json, "camera", json_numbers(9, camera));
		json_object_set_new(json, "limbus", ellipse_json(&r->view.limbus));
		json_object_set_new(json, "limbus_cov_q", json_numbers(ELLIPSE_N * ELLIPSE_N, &r->view.cov_q[0][0]));
		json_object_set_new(json, "pupil", r->view.has_pupil ? ellipse_json(&r->view.pupil) : json_null());
		json_object_set_new(json, "ramp_px", json_numbers(POSE_RAMP, r->view.ramp));
		json_object_set_new(json, "lean", json_numbers(2, r->view.lean));
		json_object_set_new(json, "reach", json_numbers(2, r->view.reach));
		json_object_set_new(json, "measured", json_numbers(6, measured));
		json_object_set_new(json, "edge_px", json_numbers(2 * ARCS, &r->point[0][0]));
		json_object_set_new(json, "edge_state", json_numbers(ARCS, state));
		if (r->by_hand)
			json_object_set_new(json, "by_hand", json_true());
	}
	bool ok = json_write(path, json, made_by, err);
	json_decref(json);
	return ok;
}

static bool ellipse_read(struct ellipse *e, const json_t *json, const char *key, const char *path, struct err *err)
{
	double v[5];
	if (!json_get_array(v, 5, json, key, path, err))
		return false;
	*e = (struct ellipse){ v[0], v[1], v[2], v[3], v[4] };
	return (e->a >= e->b && e->b > 0) || err_set(err, "%s: %s: must have a >= b > 0", path, key);
}

static bool record_read(struct limbus_record *r, const json_t *json, const char *path, struct err *err)
{
	double size[2], camera[9], measured[6], state[ARCS];
	const char *status = json_get_string(json, "status", path, err), *reason = json_get_string(json, "reason", path, err);
	r->has_guess = json_is_array(json_object_get(json, "guess"));
	r->has_rival = json_is_array(json_object_get(json, "rival"));
	if (!status || !reason || !json_get_array(size, 2, json, "size_px", path, err) || !json_get(&r->gross, json, "gross_probability", path, err)
	    || (r->has_guess && !ellipse_read(&r->guess, json, "guess", path, err)) || (r->has_rival && !ellipse_read(&r->rival, json, "rival", path, err)))
		return false;
	r->ok = !strcmp(status, "ok");
	strncpy(r->reason, reason, sizeof r->reason - 1);
	if (!(size[0] > 0 && size[0] < 1e6 && size[1] > 0 && size[1] < 1e6))
		return err_set(err, "%s: size_px: must be positive", path);
	r->width = (int)size[0];
	r->height = (int)size[1];
	if (json_object_get(json, "rough") && (!json_get(&r->rough, json, "rough", path, err) || !(r->rough > 0 && r->rough < 1)))
		return err_set(err, "%s: rough: must be a share of the semi-axis, in (0, 1)", path);
	if (!r->ok && !(r->rough > 0))
		return true;
	r->by_hand = json_is_true(json_object_get(json, "by_hand"));
	r->view.has_pupil = json_is_array(json_object_get(json, "pupil"));
	if (!json_get_array(camera, 9, json, "camera", path, err) || !ellipse_read(&r->view.limbus, json, "limbus", path, err)
	    || !json_get_array(&r->view.cov_q[0][0], ELLIPSE_N * ELLIPSE_N, json, "limbus_cov_q", path, err)
	    || (r->view.has_pupil && !ellipse_read(&r->view.pupil, json, "pupil", path, err))
	    || !json_get_array(r->view.ramp, POSE_RAMP, json, "ramp_px", path, err)
	    || !json_get_array(r->view.lean, 2, json, "lean", path, err)
	    || !json_get_array(r->view.reach, 2, json, "reach", path, err)
	    || !json_get_array(measured, 6, json, "measured", path, err)
	    || !json_get_array(&r->point[0][0], 2 * ARCS, json, "edge_px", path, err)
	    || !json_get_array(state, ARCS, json, "edge_state", path, err))
		return false;
	struct camera *c = &r->view.camera;
	c->focal_px = camera[0];
	memcpy(c->center_px, camera + 1, sizeof c->center_px);
	memcpy(c->distortion, camera + 3, sizeof c->distortion);
	c->source = camera[8] >= 0 && camera[8] <= CAMERA_RIG ? (enum camera_source)camera[8] : CAMERA_NONE;
	r->coverage = measured[0];
	r->share_used = measured[1];
	r->rms = measured[2];
	r->blur = measured[3];
	r->contrast = measured[4];
	r->view.pupil_sigma = measured[5];
	for (int i = 0; i < ARCS; i++)
		r->state[i] = state[i] >= ARC_USED ? ARC_USED : state[i] >= ARC_SEEN ? ARC_SEEN : ARC_HIDDEN;
	return true;
}

bool limbus_record_load(struct limbus_record *record, const char *path, struct err *err)
{
	*record = (struct limbus_record){ 0 };
	json_t *json = json_read(path, FILE_LIMIT, err);
	if (!json)
		return false;
	bool ok = record_read(record, json, path, err);
	json_decref(json);
	return ok;
}
