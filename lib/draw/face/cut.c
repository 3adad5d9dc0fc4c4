/* Where a character's own textures lie on its faces, and where they leave nothing of them. */
#include "draw/face/impl.h"

void portrait_uv_at(float uv[2], const struct portrait_mesh *m, int face, const float w[3])
{
	for (int c = 0; c < 2; c++)
		uv[c] = w[0] * m->uv[face][0][c] + w[1] * m->uv[face][1][c] + w[2] * m->uv[face][2][c];
}

bool portrait_cut_away(const struct portrait *p, int face, const float w[3])
{
	struct dress_point at;
	float uv[2];
	portrait_uv_at(uv, &p->mesh, face, w);
	dress_at(&at, p->conf.dress, p->mesh.material[face], uv, 0);
	return at.alpha <= 0;
}
