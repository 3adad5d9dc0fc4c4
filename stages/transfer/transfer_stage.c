#include "stages/transfer/transfer_stage.h"

#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "anatomy/keys.h"
#include "base/json.h"
#include "base/mem.h"
#include "bridge/om_mesh.h"
#include "character/import.h"
#include "mesh/mesh_part.h"
#include "mesh/outward.h"
#include "optics/camera_rig.h"
#include "register/landmarks.h"
#include "register/transfer_check.h"
#include "register/transfer_file.h"
#include "register/transfer_lay.h"
#include "register/transfer_picture.h"
#include "register/transfer_quality.h"
#include "register/transfer_unit.h"

#define RIG "work/rig.json"

enum { OUT = 4, LOOKS = 2, PROOF = 2, IN_MOST = 3 };  // of OUT the last two are there for a refused character, too

struct subject {
	const char *file;  // relative to the capture
	struct mesh mesh;  // mm
	double unit;
	bool guessed, has_eyes;
	double eye[2][3];  // centres of the left and the right eyeball, mm
};

struct target {
	char *name, **in, *out[OUT], *look_out[LOOKS];  // look_out: of a character with a look, its surface as read and its look
	int n_in;
	const char *file;  // in targets/
	struct mesh mesh;  // mm
	bool has_look;
	struct mesh read;  // with a look: the surface, in its own unit
	struct look look;  // mm
	double unit;
	bool guessed, turned;  // turned: its faces looked inwards
	struct mesh_part part;
	struct transfer result;
	struct transfer_check check;
};

static void scale(struct mesh *mesh, double unit)
{
	for (int i = 0; i < mesh->n_vertices; i++)
		for (int k = 0; k < 3; k++)
			mesh->vertices[i][k] = (float)((double)mesh->vertices[i][k] * unit);
}

/* Reports defects of a mesh that were mended. */
static void say_mended(struct stage *stage, const char *file, const struct mesh_part *p)
{
	if (p->doubled)
		stage_note(stage, "%s: %d vertices lie exactly on others: joined to them for the registration", file, p->doubled);
	if (p->flat)
		stage_note(stage, "%s: %d faces without area are passed over", file, p->flat);
	if (p->tangled)
		stage_note(stage, "%s: %d edges belong to three faces or more: normals there are means", file, p->tangled);
	if (p->left_out)
		stage_note(stage, "%s: %d of %d pieces are small or closed (eyeballs, teeth, lashes, strays): carried along, not matched",
		           file, p->left_out, p->pieces);
}

/* A subject made by calibrate is in the frame of work/rig.json, which may hold the centres of its eyeballs. */
static bool load_eyes(struct subject *s, struct stage *stage, struct err *err)
{
	struct camera_rig rig = { 0 };
	const char *path = stage_path(stage, RIG);
	if (!file_exists(path))
		return true;
	if (!camera_rig_load(&rig, path, err))
		return false;
	s->has_eyes = rig.has_eyes;
	memcpy(s->eye, rig.eye_center, sizeof s->eye);
	camera_rig_free(&rig);
	return true;
}

/* The centres of both eyeballs, where capture.conf gives them; in the mesh's unit. */
static void take_eyes(struct subject *s, const struct transfer_stage_conf *conf)
{
	static const char *const sides[] = { "left", "right" };
	int found = 0;
	for (int i = 0; i < conf->eye_center.n; i++)
		for (int e = 0; e < 2; e++)
			if (!strcmp(conf->eye_center.items[i].name, sides[e])) {
				found |= 1 << e;
				for (int k = 0; k < 3; k++)
					s->eye[e][k] = conf->eye_center.items[i].value[k] * s->unit;
			}
	s->has_eyes = found == 3;
}

static bool load_subject(struct subject *s, struct stage *stage, const struct transfer_stage_conf *conf, struct err *err)
{
	static const char *const files[] = { "subject.ply", "subject.obj", "work/subject.ply" };
	for (int i = 0; i < COUNT(files) && !s->file; i++)
		if (file_exists(stage_path(stage, "%s", files[i])))
			s->file = files[i];
	if (!s->file)
		return err_set(err, "no subject.ply or subject.obj: a character is laid onto the person's mesh; give one, or views/ to make it from");
	if (!om_mesh_load(&s->mesh, stage_path(stage, "%s", s->file), (long)conf->limit_vertices, err))
		return false;
	bool own = !strncmp(s->file, "work/", 5);  // made by calibrate, in mm
	s->guessed = !own && !isfinite(conf->subject_unit);
	s->unit = own ? 1 : s->guessed ? transfer_subject_unit(&s->mesh) : conf->subject_unit;
	scale(&s->mesh, s->unit);
	if (mesh_outward(&s->mesh) < -0.1)
		return err_set(err, "%s: its faces look inwards: turn its normals round", s->file);
	take_eyes(s, conf);
	return !own || s->has_eyes || load_eyes(s, stage, err);
}

/* Reads a character and its look, in a process of its own. */
static bool load_look(struct target *t, struct stage *stage, const struct transfer_stage_conf *conf, struct err *err)
{
	const struct character_limits limits = { (long)conf->limit_vertices, conf->import_seconds, conf->import_mib };
	struct err why = { 0 };
	if (!character_import(&t->mesh, &t->look, stage_path(stage, "targets"), t->file, &limits, &why))
		return err_set(err, "%s: %s", t->in[0], err_less(&why, stage_path(stage, "%s", t->in[0])));
	stage_note(stage, "%s: %d meshes, %d materials, %d textures, %d blend shapes%s", t->in[0], t->look.n_parts, t->look.n_materials,
	           t->look.n_textures, t->look.n_shapes, t->look.has_uv ? "" : "; without texture coordinates");
	for (int i = 0; i < t->look.n_left_out; i++)
		stage_skipped(stage, "%s: %s", t->in[0], t->look.left_out[i]);
	return true;
}

/* The look of faces that were turned round, and lengths in mm. */
static void fit_look(struct target *t)
{
	struct look *l = &t->look;
	for (int f = 0; t->turned && f < l->n_faces; f++) {
		const int32_t one = l->corner[f][1];
		l->corner[f][1] = l->corner[f][2];
		l->corner[f][2] = one;
	}
	for (int i = 0; t->turned && i < l->n_wedges; i++)
		for (int c = 0; c < 3; c++)
			l->normal[i][c] *= -1;
	for (int i = 0; i < l->shape_start[l->n_shapes]; i++)
		for (int c = 0; c < 3; c++)
			l->shape_by[i][c] *= (float)t->unit;
}

static struct mesh copy_of(const struct mesh *mesh)
{
	struct mesh out = { .n_vertices = mesh->n_vertices, .n_faces = mesh->n_faces };
	out.vertices = mem_array((size_t)out.n_vertices + 1, sizeof *out.vertices);
	out.faces = mem_array((size_t)out.n_faces + 1, sizeof *out.faces);
	memcpy(out.vertices, mesh->vertices, (size_t)out.n_vertices * sizeof *out.vertices);
	memcpy(out.faces, mesh->faces, (size_t)out.n_faces * sizeof *out.faces);
	return out;
}

static bool load_target(struct target *t, struct stage *stage, const struct subject *s, const struct transfer_stage_conf *conf, struct err *err)
{
	t->has_look = character_has_look(stage_path(stage, "%s", t->in[0]));
	if (t->has_look ? !load_look(t, stage, conf, err) : !om_mesh_load(&t->mesh, stage_path(stage, "%s", t->in[0]), (long)conf->limit_vertices, err))
		return false;
	if (!t->mesh.n_faces)
		return err_set(err, "%s: has no faces: a cloud of points cannot be registered", t->in[0]);
	t->turned = !transfer_same_topology(&t->mesh, &s->mesh) && mesh_turn_outward(&t->mesh);
	t->unit = NAN;
	for (int i = 0; i < conf->target_unit.n; i++)
		if (!strcmp(conf->target_unit.items[i].name, t->name))
			t->unit = conf->target_unit.items[i].value[0];
	t->guessed = !isfinite(t->unit);
	if (t->guessed)
		t->unit = transfer_same_topology(&t->mesh, &s->mesh) ? s->unit : transfer_target_unit(&t->mesh, &s->mesh, s->has_eyes ? s->eye : 0, &conf->transfer);
	if (t->has_look) {
		t->read = copy_of(&t->mesh);
		fit_look(t);
	}
	scale(&t->mesh, t->unit);
	if (t->turned)
		stage_note(stage, "%s: its faces look inwards: taken the other way round (if it is mirrored, its left is the subject's right)", t->in[0]);
	mesh_part_make(&t->part, &t->mesh, conf->transfer.least_piece, 0);
	say_mended(stage, t->in[0], &t->part);
	return true;
}

/* The rotation of the similarity, degrees. */
static double turned_deg(const struct transfer *r)
{
	double trace = 0;
	for (int k = 0; k < 3; k++)
		trace += r->subject_from_target[k][k] / r->scale;
	return acos(fmin(fmax((trace - 1) / 2, -1), 1)) * 180 / M_PI;
}

/* What is not refused and worth a look. */
static json_t *doubts(const struct target *t)
{
	json_t *list = json_array();
	if (t->turned)
		json_array_append_new(list, json_string("its faces look inwards and were taken the other way round: if it is mirrored, its left is the subject's right"));
	if (!t->result.same_topology && !isfinite(t->check.eyes) && !isfinite(t->check.landmarks))
		json_array_append_new(list, json_string("neither eyeballs nor landmarks could be compared: its pose follows from the shape alone"));
	if (t->result.weighed)
		json_array_append_new(list, json_string("the shapes do not tell which way up it is: taken as more of it lies below its eyes than above; else give target.NAME.landmarks"));
	if (t->check.flipped)
		json_array_append_new(list, json_string("some triangles are turned over"));
	return list;
}

static bool save_json(const struct target *t, const struct subject *s, const char *path, const char *made_by, struct err *err)
{
	const struct transfer *r = &t->result;
	const struct mesh_part *p = &t->part;
	json_t *root = json_pack("{s:s, s:s, s:b}", "target", t->in[0], "subject", s->file, "same_topology", r->same_topology);
	json_object_set_new(root, "status", json_string(*t->check.reason ? "refused" : "ok"));
	if (*t->check.reason)
		json_object_set_new(root, "reason", json_string(t->check.reason));
	json_object_set_new(root, "doubtful", doubts(t));
	json_object_set_new(root, "subject_from_target", json_numbers(16, &r->subject_from_target[0][0]));
	json_object_set_new(root, "scale", json_number(r->scale));
	json_object_set_new(root, "target_unit_mm", json_number(t->unit));
	json_object_set_new(root, "target_unit_guessed", json_boolean(t->guessed));
	json_object_set_new(root, "subject_unit_mm", json_number(s->unit));
	json_object_set_new(root, "subject_unit_guessed", json_boolean(s->guessed));
	json_object_set_new(root, "faces_looked_inwards", json_boolean(t->turned));
	json_object_set_new(root, "turned_deg", json_number(turned_deg(r)));
	json_object_set_new(root, "aligned_share", json_number(r->matched));
	json_object_set_new(root, "aligned_closely", json_number(r->fine));
	json_object_set_new(root, "aligned_closely_otherwise", json_number(r->rival));
	json_object_set_new(root, "follow_share", json_number(t->check.follow));
	json_object_set_new(root, "subject_covered", json_number(t->check.covered));
	json_object_set_new(root, "flipped_triangles", json_integer(t->check.flipped));
	json_object_set_new(root, "stretch_95", json_number(exp(t->check.stretch)));
	json_object_set_new(root, "eyes_off", json_number(t->check.eyes));
	json_object_set_new(root, "landmarks_off", json_number(t->check.landmarks));
	json_object_set_new(root, "matched_share", json_number(r->covered));
	json_object_set_new(root, "residual_rms_mm", json_number(r->rms));
	json_object_set_new(root, "distance_median_mm", json_number(transfer_distance(r, 0.5)));
	json_object_set_new(root, "distance_95_mm", json_number(transfer_distance(r, 0.95)));
	json_object_set_new(root, "vertices", json_integer(t->mesh.n_vertices));
	json_object_set_new(root, "trusted_vertices", json_integer(transfer_trusted(r)));
	json_object_set_new(root, "mended", json_pack("{s:i, s:i, s:i, s:i, s:i, s:i}", "doubled_vertices", p->doubled, "flat_faces", p->flat,
	                                              "tangled_edges", p->tangled, "boundaries", p->rims, "pieces", p->pieces,
	                                              "pieces_carried", p->left_out));
	bool ok = json_write(path, root, made_by, err);
	json_decref(root);
	return ok;
}

static bool save(struct target *t, const struct subject *s, struct stage *stage, struct err *err)
{
	const char *const *in = (const char *const *)t->in;
	const char *made_by = stage_made_by(stage, t->n_in, in);
	struct mesh registered = t->mesh;
	registered.vertices = t->result.registered;
	int first = *t->check.reason ? OUT - PROOF : 0;
	bool ok = (first
	           || (om_mesh_save(&registered, stage_path(stage, "%s", t->out[0]), made_by, err)
	               && transfer_save_matrix(&t->result, s->mesh.n_vertices, stage_path(stage, "%s", t->out[1]), made_by, err)))
	          && save_json(t, s, stage_path(stage, "%s", t->out[2]), made_by, err)
	          && transfer_save_picture(&t->result, &t->mesh, &s->mesh, stage_path(stage, "%s", t->out[3]), err);
	for (int i = 0; i < OUT && ok; i++)
		ok = i < first ? file_remove(stage_path(stage, "%s", t->out[i]), err) : stage_made(stage, t->out[i], t->n_in, in, err);
	if (ok && !first && t->has_look)
		return om_mesh_save(&t->read, stage_path(stage, "%s", t->look_out[0]), made_by, err)
		       && look_save(&t->look, stage_path(stage, "%s", t->look_out[1]), made_by, err)
		       && stage_made(stage, t->look_out[0], t->n_in, in, err) && stage_made(stage, t->look_out[1], t->n_in, in, err);
	for (int i = 0; i < LOOKS && ok; i++)
		ok = file_remove(stage_path(stage, "%s", t->look_out[i]), err);
	return ok;
}

static void report(struct stage *stage, const struct target *t)
{
	const struct transfer *r = &t->result;
	if (r->same_topology) {
		stage_note(stage, "%s: the subject's own topology: vertex goes to vertex, nothing is registered", t->name);
		stage_skipped_as_said(stage, "%s: has the subject's own topology: no registration", t->in[0]);
		return;
	}
	stage_note(stage, "%s: %.4g mm a unit%s, scale %.3f, %.0f %% of the subject found on it; %d of %d vertices follow the subject, %.2f mm from it in the median",
	           t->name, t->unit, t->guessed ? " (guessed)" : "", r->scale, 100 * r->matched, transfer_trusted(r), t->mesh.n_vertices,
	           transfer_distance(r, 0.5));
	stage_figure(stage, "aligned_share", 100 * r->matched, "%");
	stage_figure(stage, "residual_rms", r->rms, "mm");
	stage_figure(stage, "distance_95", transfer_distance(r, 0.95), "mm");
}

/* Textures and other files beside a mesh that may belong to it. */
static void add_companions(struct target *t, struct stage *stage, const struct file_list *beside, const char *file)
{
	struct stat st;
	const size_t n = strlen(file);
	const bool ply = n > 4 && !strcmp(file + n - 4, ".ply"), glb = n > 4 && !strcmp(file + n - 4, ".glb");
	if (glb || (ply && !character_has_look(stage_path(stage, "targets/%s", file))))
		return;
	for (int i = 0; i < beside->n; i++)
		if (character_kind_of(beside->names[i]) == CHARACTER_NONE && !stat(stage_path(stage, "targets/%s", beside->names[i]), &st)
		    && S_ISREG(st.st_mode)) {
			t->in = mem_grow(t->in, (size_t)t->n_in + 1, sizeof *t->in);
			t->in[t->n_in++] = mem_printf("targets/%s", beside->names[i]);
		}
}

static void target_names(struct target *t, struct stage *stage, const char *file, const struct file_list *beside, const struct subject *s)
{
	static const char *const writes[OUT] = { "registered.ply", "barycentric.npz", "registration.json", "registration.png" };
	static const char *const looks[LOOKS] = { "character.ply", "look.npz" };
	const char *dot = strrchr(file, '.');
	t->file = file;
	t->name = mem_printf("%.*s", dot ? (int)(dot - file) : (int)strlen(file), file);
	t->in = mem_new(IN_MOST, sizeof *t->in);
	t->in[0] = mem_printf("targets/%s", file);
	t->in[1] = mem_str(s->file);
	t->n_in = 2;
	if (s->has_eyes)
		t->in[t->n_in++] = mem_str(RIG);
	add_companions(t, stage, beside, file);
	for (int i = 0; i < OUT; i++)
		t->out[i] = mem_printf("work/targets/%s/%s", t->name, writes[i]);
	for (int i = 0; i < LOOKS; i++)
		t->look_out[i] = mem_printf("work/targets/%s/%s", t->name, looks[i]);
}

static void target_free(struct target *t)
{
	free(t->name);
	for (int i = 0; i < t->n_in; i++)
		free(t->in[i]);
	for (int i = 0; i < OUT; i++)
		free(t->out[i]);
	for (int i = 0; i < LOOKS; i++)
		free(t->look_out[i]);
	free(t->in);
	mesh_free(&t->mesh);
	mesh_free(&t->read);
	look_free(&t->look);
	mesh_part_free(&t->part);
	transfer_free(&t->result);
}

/* Lays a target onto the subject, and checks it. Where no pose is found, check.reason says why, and result holds it as it would lie. */
static bool lay(struct target *t, const struct subject *s, const struct nricp_landmarks *landmarks, const struct transfer_stage_conf *conf)
{
	const double (*eye)[3] = s->has_eyes ? s->eye : 0;
	struct err why = { 0 };
	if (transfer_lay(&t->result, &t->mesh, &t->part, &s->mesh, eye, landmarks, &conf->transfer, &why))
		return transfer_check(&t->check, &t->result, &t->mesh, &s->mesh, eye, landmarks, &conf->transfer, &conf->check);
	t->check = (struct transfer_check){ .eyes = NAN, .landmarks = NAN };
	snprintf(t->check.reason, sizeof t->check.reason, "%s", why.msg);
	transfer_show_aligned(&t->result, &t->mesh);
	return false;
}

/* A character that is left out: said with --quiet, too. */
__attribute__((format(printf, 2, 3)))
static void refuse(struct stage *stage, const char *fmt, ...)
{
	va_list ap;
	char *why = 0;
	va_start(ap, fmt);
	if (vasprintf(&why, fmt, ap) < 0)
		why = mem_str("refused");
	va_end(ap);
	stage_warn(stage, "%s", why);
	stage_skipped_as_said(stage, "%s", why);
	free(why);
}

/* Registers one target. Returns true when it is registered or was already; a target at fault is reported, without err. */
static bool one(struct stage *stage, const char *file, const struct file_list *beside, const struct subject *s,
                const struct transfer_stage_conf *conf, struct err *err)
{
	struct target t = { 0 };
	struct nricp_landmarks landmarks = { 0 };
	struct err why = { 0 };
	target_names(&t, stage, file, beside, s);
	bool done = true, fresh = true;
	for (int i = 0; i < OUT; i++)
		fresh = stage_fresh(stage, t.out[i], t.n_in, (const char *const *)t.in) && fresh;
	for (int i = 0; i < LOOKS; i++)
		if (file_exists(stage_path(stage, "%s", t.look_out[i])))
			fresh = stage_fresh(stage, t.look_out[i], t.n_in, (const char *const *)t.in) && fresh;
	if (!fresh) {
		done = load_target(&t, stage, s, conf, &why)
		       && landmarks_pair(&landmarks, t.name, &conf->target_landmarks, t.mesh.n_vertices, s->mesh.n_vertices,
		                         &conf->subject_landmark, err);
		if (done) {
			done = lay(&t, s, &landmarks, conf);
			if (!done)
				refuse(stage, "%s: refused: %s; see %s, and give target.%s.landmarks or unit_mm", t.in[0], t.check.reason, t.out[OUT - 1], t.name);
			done = save(&t, s, stage, err) && done;
		} else if (err_is(&why)) {
			refuse(stage, "%s", why.msg);
			for (int i = 0; i < OUT; i++)
				file_remove(stage_path(stage, "%s", t.out[i]), err);
			for (int i = 0; i < LOOKS; i++)
				file_remove(stage_path(stage, "%s", t.look_out[i]), err);
		}
		if (done)
			report(stage, &t);
	}
	free((void *)landmarks.moving);
	target_free(&t);
	return done;
}

bool transfer_stage(struct stage *stage, const struct transfer_stage_conf *conf, struct err *err)
{
	struct file_list targets = { 0 };
	struct subject s = { 0 };
	int n = 0, done = 0;
	if (keys_check_names(&stage->conf, stage->capture, err) && stage_list(stage, &targets, "targets", err) && load_subject(&s, stage, conf, err))
		for (int i = 0; i < targets.n && !err_is(err); i++)
			if (character_kind_of(targets.names[i])) {
				stage_progress(stage, n++, targets.n, "character");
				done += one(stage, targets.names[i], &targets, &s, conf, err);
			}
	if (!err_is(err) && n && !done)
		err_set(err, "none of the %d meshes in targets/ can be laid onto %s: the lines above say why", n, s.file);
	mesh_free(&s.mesh);
	file_list_free(&targets);
	return !err_is(err);
}
