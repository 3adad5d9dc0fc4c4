#include "tests/lib/scenes/portrayed.h"

#include "draw/eye/levels.h"

bool portrayed_make(struct portrayed *p, double below)
{
	struct err err = { 0 };
	struct rig_conf conf = face_conf();
	*p = (struct portrayed){ 0 };
	face_make(&p->face, false);
	conf.map_step = 4;
	bool ok = face_rig(&p->rig, 0, &p->face, &conf, &err);
	struct eye eye = { .cornea_radius = 7.8, .cornea_asphericity = 0.75, .index = 1.336, .limbus_radius = 5.85, .limbus_aspect = 1, .iris_depth = 3.3 };
	struct scene_conf scene = { .map_size = 256, .search = 2, .steps = 4, .bands = 3, .detail = 1, .own_width = 0.2, .ratio_most = 2.5, .ratio_chroma = 1.5, .limbus_width = 0.5,
		                        .sclera_radius = 11.8, .sclera_rgb = { 0.7, 0.7, 0.7 }, .vein_density = 0, .veins_px = 128, .seed = 1 };
	scene_plain(&p->eye, &eye, &scene, (double[]){ 0.2, 0.2, 0.2 }, 1, 0);
	p->env = envmap_room(64, (double[]){ 1, 1, 1 }, (double[]){ below, below, below }, 1, 0, 0);
	return ok;
}

void portrayed_free(struct portrayed *p)
{
	scene_free(&p->eye);
	envmap_free(&p->env);
	rig_free(&p->rig);
	face_free(&p->face);
}
