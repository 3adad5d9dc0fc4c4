/* poser: a rig and its hairs in one pose after the other, as displacements from rest, mm. For the files of this folder. */
#ifndef RIG_GLB_POSER_H
#define RIG_GLB_POSER_H
#include "rig/deform/arc.h"
#include "rig/deform/deform.h"
#include "rig/glb/glb.h"

struct poser {
	const struct rig *rig;
	struct deform *deform;
	float (*x)[3], (*n)[3];   // [rig.n] now: places; normals of the surface there, for algorithm 1's know no unfolding skin
	int n_faces, *face;       // of the rig, that move
	struct deform_near near;
	const struct glb_conf *conf;
	int n_strands, n_hair;    // vertices of hairs (strands.h); with those of the tears (tears.h) behind them
	float (*hair)[3], (*hair_rest)[3];
	double turn[2][3][3];     // of the globes now
};

/* At rest. poser_free. */
struct poser poser_new(const struct rig *rig, const struct glb_conf *conf);
void poser_free(struct poser *poser);

/* controls: g~ [rig.n_inputs]; turn: out, the globes' rotations. */
void poser_pose(struct poser *poser, const double *controls, double turn[2][3][3]);

/* The rig at rest (rig.rest_e), eyes straight ahead: what lies in an eyeball is put before it, as in every pose. */
void poser_still(struct poser *poser);

/* The rig on its way from there to a pose, both eyes straight ahead: its components go in a straight line. share: 0 at rest, 1 the pose. */
void poser_from_still(struct poser *poser, const double *controls, double share);

/* Displacements of n vertices of the rig and of their normals, x[n][3], lean[n][3], out; of the hairs' vertices, out[n_hair][3]. */
void poser_skin(float *x, float *lean, const struct poser *poser, int n, const int *vertex);
void poser_hair(float *out, const struct poser *poser);

/* Share of an eye in what moves at x, of the rig at rest: 1 on its side of the face, 0 on the other. */
float poser_own_side(const struct poser *poser, int eye, const float x[3]);

#endif
