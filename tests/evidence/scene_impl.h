/* What is drawn in one picture; private to scene and open_eye. */
#ifndef EVIDENCE_SCENE_IMPL_H
#define EVIDENCE_SCENE_IMPL_H
#include "face.h"
#include "scene.h"
#include "ball.h"

struct set {
	struct face face;
	struct ball ball[2];
	struct light light;
	float white[3];
	bool bare;  // eyeballs without lids or face
};

/* Place of a pixel's centre on the face, mm. */
static inline void face_uv(float uv[2], const struct canvas *c, int i, int j)
{
	const float x = (float)i + 0.5F, y = (float)j + 0.5F;
	uv[0] = c->at[0] + c->m[0][0] * x + c->m[0][1] * y;
	uv[1] = c->at[1] + c->m[1][0] * x + c->m[1][1] * y;
}

/* One eye between its lids; where it is open. */
void open_eye_draw(struct canvas *canvas, const struct set *set, int eye);

/* Two eyeballs without lids, before whatever is there. */
void open_eye_bare(struct canvas *canvas, const struct set *set, struct rng *rng, bool test);

#endif
