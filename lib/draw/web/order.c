/* Selects the vertices of a character that the page has, and orders them: face_impl.h. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "draw/web/face_impl.h"
#include "math/vec.h"
#include "rig/deform/terms.h"

static bool shown(const struct web_face *f, const int32_t v[3], double reach)
{
	for (int j = 0; j < 3; j++) {
		double d[3], x[3];
		for (int c = 0; c < 3; c++)
			d[c] = f->portrait->mesh.x[v[j]][c] - f->middle[c];
		mat_vec(x, f->rig->head_from_target, d);
		if (fabs(x[0]) > reach || fabs(x[1]) > reach || fabs(x[2]) > reach)
			return false;
	}
	return true;
}

/* Adds what those shown are made from: the roots of hairs, the ends of subdivided edges, and the neighbours that normals of the rig's
 * own vertices need. */
static void need(bool *used, const struct web_face *f)
{
	const struct portrait_mesh *m = &f->portrait->mesh;
	const struct rig *rig = f->rig;
	for (int i = m->n; i < f->n; i++) {
		struct portrait_pin pin;
		if (!used[i])
			continue;
		used[m->n + ((i - m->n) ^ 1)] = true;  // the other side of the hair
		portrait_lash_pin(&pin, f->portrait, i);
		for (int j = 0; j < 3; j++)
			used[pin.vertex[j]] = true;
	}
	for (int i = m->n - 1; i >= m->n_base; i--)
		for (int j = 0; j < 2 && used[i]; j++)
			used[m->between[i - m->n_base][j]] = true;
	bool *mate = mem_new((size_t)rig->n + 1, sizeof *mate);
	for (int i = 0; i < rig->n_faces; i++) {
		const int32_t *v = rig->faces[i];
		for (int j = 0; j < 3 && (used[v[0]] || used[v[1]] || used[v[2]]); j++)
			mate[v[j]] = true;
	}
	for (int i = 0; i < rig->n; i++)
		used[i] = used[i] || mate[i];
	free(mate);
}

/* True when a vertex's light differs by more than 3 steps of 255 between poses. */
static bool light_changes(const struct web_face *f, int i)
{
	for (int k = 1; k < POSES + f->n_au; k++)
		for (int c = 0; c < 3; c++)
			if (abs(f->light[k][i][c] - f->light[0][i][c]) > 3)
				return true;
	return false;
}

/* Marks the vertices that move, whose light changes, or that have a neighbour that moves, since their normal changes. */
static bool *posed_of(const struct web_face *f)
{
	const struct portrait_mesh *m = &f->portrait->mesh;
	const struct rig *rig = f->rig;
	bool *moves = mem_new((size_t)rig->n + 1, sizeof *moves), *posed = mem_new((size_t)f->n + 1, sizeof *posed);
	for (int i = 0; i < rig->n; i++)
		moves[i] = deform_terms_moves(rig, i);
	for (int i = 0; i < rig->n_faces; i++) {
		const int32_t *v = rig->faces[i];
		for (int j = 0; j < 3 && (moves[v[0]] || moves[v[1]] || moves[v[2]]); j++)
			posed[v[j]] = true;
	}
	for (int i = 0; i < rig->n; i++)
		posed[i] = posed[i] || moves[i] || light_changes(f, i);
	for (int i = m->n_base; i < m->n; i++)
		posed[i] = posed[m->between[i - m->n_base][0]] || posed[m->between[i - m->n_base][1]];
	free(moves);
	return posed;
}

static int *levels_of(const struct portrait_mesh *m)
{
	int *level = mem_new((size_t)m->n + 1, sizeof *level);
	for (int i = m->n_base; i < m->n; i++) {
		const int *e = m->between[i - m->n_base];
		level[i] = 1 + (level[e[0]] > level[e[1]] ? level[e[0]] : level[e[1]]);
	}
	return level;
}

static void put_in_order(struct web_face *f, const bool *used)
{
	const struct portrait_mesh *m = &f->portrait->mesh;
	bool *posed = posed_of(f);
	int *level = levels_of(m), n = 0;
	f->order = mem_array((size_t)f->n + 1, sizeof *f->order);
	f->place = mem_array((size_t)f->n + 1, sizeof *f->place);
	for (int i = 0; i < f->n; i++)
		f->place[i] = -1;
	for (f->n_levels = 0; f->n_levels < LEVELS; f->n_levels++) {
		struct web_level *l = &f->level[f->n_levels];
		l->first = l->posed = n;
		for (int still = 0; still < 2; still++) {
			for (int i = 0; i < m->n; i++)
				if (used[i] && level[i] == f->n_levels && posed[i] == !still)
					f->order[n++] = i;
			l->posed = still ? l->posed : n;
		}
		l->end = n;
		if (l->end == l->first)
			break;
	}
	f->first_hair = n;
	for (int i = m->n; i < f->n; i++)
		if (used[i])
			f->order[n++] = i;
	f->n_shown = n;
	for (int i = 0; i < n; i++)
		f->place[f->order[i]] = i;
	free(posed);
	free(level);
}

/* Renumbers the faces whose corners are all on the page; returns how many. */
static int placed(uint32_t (*out)[3], const struct web_face *f, int n, const int32_t (*faces)[3])
{
	int count = 0;
	for (int i = 0; i < n; i++) {
		const int32_t *v = faces[i];
		if (f->place[v[0]] < 0 || f->place[v[1]] < 0 || f->place[v[2]] < 0)
			continue;
		for (int j = 0; j < 3; j++)
			out[count][j] = (uint32_t)f->place[v[j]];
		count++;
	}
	return count;
}

void web_order(struct web_face *f, double reach)
{
	const struct portrait_mesh *m = &f->portrait->mesh;
	bool *used = mem_new((size_t)f->n + 1, sizeof *used);
	int32_t (*seen)[3] = mem_array((size_t)m->n_faces + 1, sizeof *seen);
	int n_seen = 0;
	for (int i = 0; i < m->n_faces; i++)
		if (!(i < m->n_dressed && m->cuts[i]) && shown(f, m->faces[i], reach)) {
			for (int j = 0; j < 3; j++)
				used[m->faces[i][j]] = true;
			memcpy(seen[n_seen++], m->faces[i], sizeof *seen);
		}
	need(used, f);
	put_in_order(f, used);
	f->faces = mem_array((size_t)n_seen + 1, sizeof *f->faces);
	f->ring = mem_array((size_t)f->rig->n_faces + 1, sizeof *f->ring);
	f->n_faces = placed(f->faces, f, n_seen, (const int32_t(*)[3])seen);
	f->n_ring = placed(f->ring, f, f->rig->n_faces, (const int32_t(*)[3])f->rig->faces);
	free(seen);
	free(used);
}

void web_order_free(struct web_face *f)
{
	free(f->order);
	free(f->place);
	free(f->faces);
	free(f->ring);
}
