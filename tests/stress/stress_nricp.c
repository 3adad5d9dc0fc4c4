/* A character laid onto a subject where meshes are hard: triangles without area, vertices twice, pieces apart, other scales,
 * turned by half a turn, nothing in common, absurd numbers. Never a NaN, never a row of B that is no average, always
 * a verdict: a registration, or one line that says why not. */
#include <float.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "tests/lib/stress.h"
#include "tests/lib/conf/transfer_conf.h"

enum { MOST = 900 };

/* A lump without symmetry: a sphere with bumps, open at the back. radius mm. */
static struct mesh lump(int rings, int around, double radius, double shape)
{
	struct mesh m = { .n_vertices = rings * around };
	m.vertices = mem_new(2 * MOST, sizeof *m.vertices);
	m.faces = mem_new(8 * MOST, sizeof *m.faces);
	for (int i = 0; i < rings; i++)
		for (int j = 0; j < around; j++) {
			double u = 0.2 + 2.1 * i / (rings - 1), v = 2 * M_PI * j / around;
			double r = radius * (1 + 0.25 * sin(u + 0.3) * cos(v - 0.4) + 0.12 * cos(2 * v + 1) * sin(2 * u) + shape * sin(3 * u + 2 * v));
			float *p = m.vertices[i * around + j];
			p[0] = (float)(1.3 * r * sin(u) * cos(v));
			p[1] = (float)(0.9 * r * sin(u) * sin(v));
			p[2] = (float)(r * cos(u));
		}
	for (int i = 0; i + 1 < rings; i++)
		for (int j = 0; j < around; j++) {
			int a = i * around + j, b = i * around + (j + 1) % around;
			memcpy(m.faces[m.n_faces++], (int32_t[]){ a, a + around, b }, sizeof *m.faces);
			memcpy(m.faces[m.n_faces++], (int32_t[]){ b, a + around, b + around }, sizeof *m.faces);
		}
	return m;
}

static void move(struct mesh *m, const double axis[3], double angle, double scale, const double shift[3])
{
	double c = cos(angle), s = sin(angle);
	for (int i = 0; i < m->n_vertices; i++) {
		float *p = m->vertices[i];
		double x[3] = { (double)p[0], (double)p[1], (double)p[2] }, along = axis[0] * x[0] + axis[1] * x[1] + axis[2] * x[2];
		double across[3] = { axis[1] * x[2] - axis[2] * x[1], axis[2] * x[0] - axis[0] * x[2], axis[0] * x[1] - axis[1] * x[0] };
		for (int k = 0; k < 3; k++)
			p[k] = (float)(scale * (c * x[k] + s * across[k] + (1 - c) * along * axis[k]) + shift[k]);
	}
}

/* of the moving and the fixed mesh */
enum harm { NO_AREA = 1, TWICE = 2, LOOSE = 4, PIECES = 8, ABSURD = 16, FLIPPED = 32, NO_FACES = 64, ONE_PLACE = 128, HALF = 256, OTHER = 512 };

static void harm(struct mesh *m, struct rng *rng, int kinds)
{
	int n = m->n_vertices, faces = m->n_faces;
	for (int f = 0; f < faces && kinds & NO_AREA; f += 1 + rng_below(rng, 12))
		m->faces[f][1] = m->faces[f][rng_below(rng, 2) ? 0 : 2];
	for (int i = 0; i < n && kinds & NO_AREA; i += 5 + rng_below(rng, 20))  // corners that fall together
		memcpy(m->vertices[i], m->vertices[(i + 1) % n], sizeof *m->vertices);
	for (int i = 0; i < n && kinds & TWICE && m->n_vertices < 2 * MOST; i += 1 + rng_below(rng, 3)) {
		memcpy(m->vertices[m->n_vertices], m->vertices[i], sizeof *m->vertices);
		for (int f = 0; f < m->n_faces; f += 2)
			for (int k = 0; k < 3; k++)
				if (m->faces[f][k] == i)
					m->faces[f][k] = m->n_vertices;
		m->n_vertices++;
	}
	for (int k = 0; k < 20 && kinds & LOOSE && m->n_vertices < 2 * MOST; k++, m->n_vertices++)
		for (int c = 0; c < 3; c++)
			m->vertices[m->n_vertices][c] = (float)rng_range(rng, -100, 100);
	for (int f = 0; f < m->n_faces && kinds & PIECES; f++)
		if (f % 7 == 3)
			memmove(m->faces + f, m->faces + f + 1, (size_t)(--m->n_faces - f) * sizeof *m->faces);
	static const float strange[] = { 1e9f, -1e9f, 1e7f, 1e-40f };  // what mesh_load lets through
	for (int k = 0; k < 3 && kinds & ABSURD; k++)
		m->vertices[rng_below(rng, m->n_vertices)][rng_below(rng, 3)] = strange[rng_below(rng, COUNT(strange))];
	for (int f = 0; f < m->n_faces && kinds & FLIPPED; f += 1 + rng_below(rng, 3)) {
		int32_t t = m->faces[f][0];
		m->faces[f][0] = m->faces[f][1];
		m->faces[f][1] = t;
	}
	for (int f = m->n_faces; f-- > 0 && kinds & HALF;)  // triangles of one side alone
		if ((m->vertices[m->faces[f][0]][0] > 0) == !(kinds & OTHER))
			memmove(m->faces + f, m->faces + f + 1, (size_t)(--m->n_faces - f) * sizeof *m->faces);
	if (kinds & NO_FACES)
		m->n_faces = 0;
	for (int i = 1; i < m->n_vertices && kinds & ONE_PLACE; i++)
		memcpy(m->vertices[i], m->vertices[0], sizeof *m->vertices);
}

static void judge(struct stress *s, const struct transfer *t, const struct mesh *subject)
{
	if (!isfinite(t->scale + t->matched + t->rms + t->covered) || !(t->scale > 0))
		stress_wrong(s, "scale %g, matched %g, rms %g, covered %g", t->scale, t->matched, t->rms, t->covered);
	for (int i = 0; i < t->n; i++) {
		double sum = 0;
		for (int k = 0; k < 3; k++) {
			sum += t->weight[i][k];
			if (!isfinite(t->registered[i][k]) || !(t->weight[i][k] >= 0) || t->column[i][k] < 0 || t->column[i][k] >= subject->n_vertices) {
				stress_wrong(s, "vertex %d: at %g, weight %g of column %d", i, (double)t->registered[i][k], t->weight[i][k], t->column[i][k]);
				return;
			}
		}
		if (!(fabs(sum - 1) < 1e-5) || !(t->confidence[i] >= 0 && t->confidence[i] <= 1) || !isfinite(t->distance[i])) {
			stress_wrong(s, "vertex %d: weights sum to %g, confidence %g, distance %g", i, sum, (double)t->confidence[i], (double)t->distance[i]);
			return;
		}
	}
}

/* fair: what must succeed, and lie on the subject. */
static void one(struct stress *s, int kinds_moving, int kinds_fixed, double angle, double scale, double together, double apart, bool fair)
{
	struct rng *rng = &s->rng;
	struct transfer_conf conf = transfer_defaults;
	const double none[3] = { 0 };
	double axis[3], length = 0, shift[3];
	for (int k = 0; k < 3; k++)
		length = hypot(length, axis[k] = rng_normal(rng));
	for (int k = 0; k < 3; k++) {
		axis[k] /= length;
		shift[k] = apart * rng_normal(rng);
	}
	struct mesh subject = lump(12 + rng_below(rng, 10), 16 + rng_below(rng, 16), 60, 0), target = lump(14 + rng_below(rng, 8), 17 + rng_below(rng, 12), 60, 0.03);
	move(&target, axis, angle, scale, shift);
	if (together != 1) {
		move(&target, axis, 0, together, none);
		move(&subject, axis, 0, together, none);
	}
	harm(&target, rng, kinds_moving);
	harm(&subject, rng, kinds_fixed);
	stress_about(s, "%d and %d vertices, harm %d and %d, turned %.0f deg, scale %.3g, both %.3g, moved %.3g mm", target.n_vertices, subject.n_vertices,
	             kinds_moving, kinds_fixed, angle * 180 / M_PI, scale, together, apart);
	struct transfer t = { 0 };
	struct err err = { 0 };
	bool ok = transfer_run(&t, &target, &subject, 0, &conf, &err);
	if (!ok) {
		stress_flagged(s);
		if (s->show)
			printf("  %s\n", err.msg);
		if (!err_is(&err) || strchr(err.msg, '\n'))
			stress_wrong(s, "refused without a line");
		if (fair)
			stress_wrong(s, "refused: %.150s", err.msg);
	} else {
		judge(s, &t, &subject);
		stress_measure(s, t.rms / together, "mm of 60 from the subject");
	}
	transfer_free(&t);
	mesh_free(&subject);
	mesh_free(&target);
}

int main(int argc, char **argv)
{
	struct stress s;
	stress_start(&s, "nricp", argc, argv);
	for (stress_family(&s, "turned anyhow, and by half a turn", 24); stress_case(&s);)
		one(&s, 0, 0, s.index % 2 ? M_PI : rng_range(&s.rng, 0, M_PI), 1, 1, 10, true);
	for (stress_family(&s, "triangles without area, vertices twice, loose, pieces, turned triangles", 60); stress_case(&s);) {
		int moving = rng_below(&s.rng, 64) & ~ABSURD, fixed = rng_below(&s.rng, 64) & ~ABSURD;
		one(&s, moving, fixed, rng_range(&s.rng, 0, 0.3), 1, 1, 5, false);
	}
	for (stress_family(&s, "both of scales of 1e-6 to 1e6", 24); stress_case(&s);)
		one(&s, 0, 0, 0.1, 1, pow(10, rng_range(&s.rng, -6, 6)), 1, true);
	for (stress_family(&s, "one of another scale", 24); stress_case(&s);)
		one(&s, 0, 0, 0.1, pow(10, rng_range(&s.rng, -6, 6)), 1, 1, false);
	for (stress_family(&s, "far apart", 16); stress_case(&s);)
		one(&s, 0, 0, 0.1, 1, 1, pow(10, rng_range(&s.rng, 2, 7)), false);
	for (stress_family(&s, "nothing in common: the front's left and right half", 16); stress_case(&s);)
		one(&s, HALF, HALF | OTHER, 0.1, 1, 1, 1, false);
	for (stress_family(&s, "absurd numbers, no faces, all in one place", 60); stress_case(&s);) {
		static const int kinds[] = { ABSURD, NO_FACES, ONE_PLACE, ABSURD | TWICE, 0 };
		int moving = kinds[rng_below(&s.rng, COUNT(kinds))], fixed = kinds[rng_below(&s.rng, COUNT(kinds))];
		one(&s, moving, fixed, 0.1, 1, 1, 1, false);
	}
	return stress_end(&s);
}
