#include <math.h>
#include <stdlib.h>

#include "tests/evidence/scene.h"
#include "tests/lib/unseen/unseen_impl.h"

static int label_at(const struct drawn *d, const struct ellipse *e, double t, double scale)
{
	const double u = scale * e->a * cos(t), v = scale * e->b * sin(t), x = e->cx + u * cos(e->angle) - v * sin(e->angle),
	             y = e->cy + u * sin(e->angle) + v * cos(e->angle);
	return x < 0 || y < 0 || x >= d->width || y >= d->height ? -1 : d->label[(long)y * d->width + (long)x];
}


double unseen_showing(const struct drawn *d, const struct ellipse *e)
{
	int n = 0;
	for (int i = 0; i < 360; i++) {
		const int in = label_at(d, e, i * M_PI / 180, 0.97), out = label_at(d, e, i * M_PI / 180, 1.03);
		n += (in == EVIDENCE_IRIS || in == EVIDENCE_PUPIL) && out == EVIDENCE_SCLERA;
	}
	return n / 360.0;
}

struct unseen_eye unseen_eye_of(const struct drawn *d, int k)
{
	const float *l = d->eye[k].limbus, *p = d->eye[k].pupil;
	const struct ellipse limbus = { l[0], l[1], l[2], l[3], l[4] };
	return (struct unseen_eye){ limbus, { p[0], p[1], p[2], p[3], p[4] }, unseen_showing(d, &limbus), d->eye[k].theta };
}

bool unseen_leans(const struct drawn *d, double turn)
{
	return d->aspect < 0.99F && fabs(turn) > 0.1;
}

bool unseen_draw(struct unseen *u, uint64_t number, const struct unseen_frame *f)
{
	const struct drawn_view view = { .radius = (float)f->radius, .x = (float)f->x, .y = (float)f->y, .turn = (float)f->turn, .mirrored = f->mirrored };
	struct drawn d = drawn_photograph(number, &view, f->width, f->height);
	u->maker = UNSEEN_DRAWN;
	u->aspect = d.aspect;
	u->leans = unseen_leans(&d, f->turn);
	u->warmth = d.white[0] / d.white[2];
	u->photo = unseen_photo(d.rgb, d.width, d.height);
	double nearest = INFINITY;
	for (int e = 0; e < d.n_eyes; e++) {
		const float *l = d.eye[e].limbus;
		const double away = hypot(l[0] - f->x, l[1] - f->y);
		const int at = away < nearest ? 0 : u->n;
		if (u->n && at == 0)
			u->eye[1] = u->eye[0];
		u->eye[at] = unseen_eye_of(&d, e);
		if (at == 0) {
			nearest = away;
			u->opening = d.eye[e].openness;
		}
		u->n++;
	}
	drawn_free(&d);
	return u->n > 0 && u->opening > 0;
}
