/* posed RIG.npz [own] [settled]: a rig's vertices and their normals (area-weighted) as lib/rig/deform/deform.c poses them, for each line of standard
 * input: gaze of the left eye and of the right (two numbers each, degrees), how far open each is of what is usual there, and
 * expressions, with which its lids go. Standard output: floats [lines][2][vertices][3]; own: of the character's mesh alone, without lining;
 * settled: with lids as pictures have them (deform_settle). */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "mesh/mesh.h"
#include "rig/deform/arc.h"
#include "rig/deform/deform.h"
#include "rig/deform/lifted.h"
#include "rig/drive.h"

/* Controls of one line; false where it does not say them all. */
static bool controls_of(double *c, const struct rig *rig, char *line)
{
	double look[2][2], open[2], *one = mem_new((size_t)rig->n_inputs + 1, sizeof *one);
	char *word = line;
	bool ok = true;
	for (int i = 0; i < 6; i++) {
		char *from = word;
		double v = strtod(from, &word);
		ok = ok && word > from;
		*(i < 4 ? &look[i / 2][i % 2] : &open[i - 4]) = v;
	}
	for (int side = 0; side < 2; side++) {
		drive_look(one, rig, look[side][0], look[side][1], open[side]);
		memcpy(c + 5 * side, one + 5 * side, 5 * sizeof *c);
	}
	for (int i = 10; i < rig->n_inputs; i++)
		c[i] = strtod(word, &word);
	for (int side = 0; side < 2; side++)
		express_eye(c + 5 * side + 3, side, rig->n_inputs - 10, c + 10, (const double(*)[EXPRESS_LIDS])rig->expression, rig->aperture_px, open[side]);
	free(one);
	return ok;
}

int main(int argc, char **argv)
{
	struct rig rig = { 0 };
	struct err err = { 0 };
	char line[512];
	if (argc < 2 || argc > 4 || !rig_load(&rig, argv[1], &err)) {
		fprintf(stderr, "posed: %s\n", argc >= 2 && argc <= 4 ? err.msg : "RIG.npz [own] [settled]");
		return 2;
	}
	const bool own = argc > 2 && !strcmp(argv[2], "own"), settled = argc > 2 && !strcmp(argv[argc - 1], "settled");
	const int n = own ? rig_own_vertices(&rig) : rig.n;
	struct deform_near near = deform_near_of(&rig);
	struct deform *deform = deform_new(&rig);
	float (*x)[3] = mem_array((size_t)rig.n, sizeof *x);
	double *c = mem_new((size_t)rig.n_inputs, sizeof *c), e[RIG_COMPONENTS], turn[2][3][3];
	deform_rest(deform, x, 0);
	while (fgets(line, sizeof line, stdin) && controls_of(c, &rig, line)) {
		double lifted[2];
		deform_lifted(lifted, &near, &rig, c);
		rig_components(e, &rig, c);
		rig_globes_turned(turn, &rig, c);
		deform_pose(deform, e, (const double(*)[3][3])turn, x, 0);
		if (settled)
			deform_settle(x, &rig, &near, (const double(*)[3][3])turn, lifted);
		struct mesh mesh = { rig.n, rig.n_faces, x, rig.faces, 0 };
		float (*normal)[3] = mesh_normals(&mesh);
		fwrite(x, sizeof *x, (size_t)n, stdout);
		fwrite(normal, sizeof *normal, (size_t)n, stdout);
		free(normal);
	}
	free(c);
	free(x);
	deform_near_free(&near);
	deform_free(deform);
	rig_free(&rig);
	return fflush(stdout) != 0;
}
