#include "tests/lib/scenes/driven.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "rig/deform/deform.h"
#include "rig/drive.h"

bool driven_make(struct driven *d, const struct hair_conf *hair, struct err *err)
{
	struct rig_conf conf = face_conf();
	*d = (struct driven){ 0 };
	face_make(&d->face, false);
	conf.map_step = 4;
	if (!face_rig(&d->rig, 0, &d->face, &conf, err))
		return false;
	hairs_grow(&d->hairs, &d->rig, 0, hair);
	return true;
}

void driven_free(struct driven *d)
{
	hairs_free(&d->hairs);
	rig_free(&d->rig);
	face_free(&d->face);
}

void driven_pose(float (*x)[3], double turn[2][3][3], const struct driven *d, double horizontal, double vertical, double open)
{
	double e[RIG_COMPONENTS], *c = calloc((size_t)d->rig.n_inputs, sizeof *c);
	struct deform *deform = deform_new(&d->rig);
	drive_look(c, &d->rig, horizontal, vertical, open);
	rig_components(e, &d->rig, c);
	rig_globes_turned(turn, &d->rig, c);
	deform_rest(deform, x, 0);
	deform_pose(deform, e, (const double(*)[3][3])turn, x, 0);
	deform_free(deform);
	free(c);
}

struct drive driven_wanders(const struct driven *d, int frames)
{
	const int inputs = d->rig.n_inputs;
	struct drive drive = { frames, inputs, calloc((size_t)frames, sizeof(double)), calloc((size_t)(inputs * frames), sizeof(double)), 0 };
	for (int f = 0; f < frames; f++) {
		drive.time[f] = f / 30.0;
		drive_look(drive_at(&drive, f), &d->rig, 15 * sin(f / 7.0), 10 * cos(f / 11.0), f > 25 && f < 32 ? 0 : 1);
	}
	return drive;
}

struct glb_conf driven_glb(const struct driven *d)
{
	static const char *const expressions[] = { "brows_up", "squint" };
	return (struct glb_conf){ .targets = 20, .tolerance = 0.02, .poses = true, .skin_rgb = { 0.5, 0.3, 0.2 }, .tear_mm = 0.3, .n_expressions = 2, .expression = expressions, .hairs = &d->hairs };
}

int driven_setup(void **state)
{
	struct driven *m = mem_new(1, sizeof *m);
	struct err err = { 0 };
	*state = m;
	return driven_make(m, &(struct hair_conf){ 0 }, &err) ? 0 : 1;
}

int driven_teardown(void **state)
{
	driven_free(*state);
	free(*state);
	return 0;
}

int wandering_setup(void **state)
{
	struct wandering *w = mem_new(1, sizeof *w);
	struct err err = { 0 };
	bool ok = driven_make(&w->on, &(struct hair_conf){ .lash_mm = 9, .brow_mm = 8, .lashes = 40, .brow_hairs = 60, .margin_mm = 1.1 }, &err);
	w->drive = driven_wanders(&w->on, WANDERING_FRAMES);
	w->conf = driven_glb(&w->on);
	*state = w;
	return ok ? 0 : 1;
}

int wandering_teardown(void **state)
{
	struct wandering *w = *state;
	drive_free(&w->drive);
	driven_free(&w->on);
	free(w);
	return 0;
}
