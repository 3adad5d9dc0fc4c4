#include "track/clip/outlines.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "limbus/evidence.h"

struct outlines {
	const struct track_clip *clip;
	const struct track_subject *subject;
	struct evidence_net *net;
	struct bulk *bulk;
	double limbus, least_area;     // mm, of an average eye; squares of the iris' radius
	struct track_outlines_conf conf;
	double looked[SIDES], gap[SIDES];  // time of the last frame that was looked at, and the opening in it, of the iris' radius
	long frames;                   // pushed
	struct track_outline *seen;    // bulk
	long n, room, packed;
};

struct outlines *outlines_new(const struct track_clip *clip, const struct track_subject *subject, struct bulk *bulk, const struct track_conf *conf)
{
	struct evidence_net *net = 0;
	struct err none = { 0 };
	if (subject->assumed || conf->limit || !(conf->canthi.mesh_sigma > 0) || !(conf->outlines.every_s > 0) || !evidence_open_shipped(&net, &none))
		return 0;
	struct outlines *o = mem_new(1, sizeof *o);
	*o = (struct outlines){ .clip = clip, .subject = subject, .net = net, .bulk = bulk, .conf = conf->outlines, .limbus = conf->eye.limbus_radius,
		                    .least_area = conf->canthi.least_area, .looked = { -INFINITY, -INFINITY } };
	return o;
}

/* Where the iris of an eye that looks straight on is, px, and the eye's axes in the picture. */
static bool place_of(double place[3], double across[2], double down[2], const struct outlines *o, int side, const double pose[4][4])
{
	const struct track_subject *s = o->subject;
	const double limbus = s->limbus[side] > 0 ? s->limbus[side] : o->limbus;
	double p[3], corner[2][2];
	if (!s->opening[side].open || !s->margin[side].open || !head_project(place, &o->clip->camera, pose, s->opening[side].center))
		return false;
	for (int c = 0; c < 2; c++)
		if (!head_project(corner[c], &o->clip->camera, pose, s->margin[side].canthus[c]))
			return false;
	head_from(p, pose, s->opening[side].center);
	place[2] = o->clip->camera.focal_px * limbus / p[2];
	const double wide = hypot(corner[1][0] - corner[0][0], corner[1][1] - corner[0][1]);
	for (int k = 0; k < 2; k++)
		across[k] = (corner[1][k] - corner[0][k]) / fmax(wide, 1e-9);
	const double chin = across[1] * pose[0][1] - across[0] * pose[1][1] < 0 ? -1 : 1;
	down[0] = -across[1] * chin;
	down[1] = across[0] * chin;
	return place[2] > 1 && wide > 8;
}

static struct photo photo_of(const struct eye_frame *frame, const int box[4])
{
	struct photo photo = { .width = box[2] - box[0], .height = box[3] - box[1], .bits = 8 };
	photo.rgb = mem_array(3 * (size_t)photo.width * (size_t)photo.height, sizeof *photo.rgb);
	for (int y = 0; y < photo.height; y++)
		for (int i = 0; i < 3 * photo.width; i++)
			photo.rgb[3L * y * photo.width + i] = (uint16_t)(257 * frame->rgb[(long)(box[1] + y) * frame->rgb_stride + 3L * box[0] + i]);
	return photo;
}

/* True where it is time to look, or the opening has changed since. */
static bool due(struct outlines *o, int side, double time, double gap)
{
	const double early = 1e-3;  // s: time stamps are rounded
	if (time - o->looked[side] < o->conf.every_s - early && !(fabs(gap - o->gap[side]) > o->conf.again))
		return false;
	o->looked[side] = time;
	o->gap[side] = gap;
	return true;
}

static void look(struct outlines *o, int side, const struct eye_frame *frame, const struct eye_state *state, const int box[4])
{
	struct evidence e;
	struct track_outline t;
	struct err none = { 0 };
	double place[3], across[2], down[2];
	memset(&t, 0, sizeof t);  // its bytes are kept
	if (!place_of(place, across, down, o, side, frame->cam_from_head) || !due(o, side, frame->time, outlines_gap(state) / place[2]))
		return;
	struct photo photo = photo_of(frame, box);
	if (evidence_window(&e, o->net, &photo, place[0] - box[0], place[1] - box[1], place[2], &none)) {
		e.x0 += box[0];
		e.y0 += box[1];
		if (eye_outline_of(&t.at, &e, place, across, down, o->least_area)) {
			if (o->n == o->room) {
				o->room += o->room / 4 + 256;
				o->seen = bulk_grow(o->bulk, o->seen, (size_t)o->room, sizeof *o->seen);
			}
			t.frame = o->frames;
			t.side = side;
			o->seen[o->n++] = t;
		}
		evidence_free(&e);
	}
	free(photo.rgb);
}

void outlines_push(struct outlines *o, const struct eye_frame *frame, const struct eye_state *const state[SIDES], const bool in[SIDES], const int box[SIDES][4])
{
	for (int e = 0; e < SIDES; e++)
		if (in[e])
			look(o, e, frame, state[e], box[e]);
	o->frames++;
}

double outlines_gap(const struct eye_state *s)
{
	const int n = s->lid_points;
	const double gap = n ? hypot(s->lid[LID_LOWER][n / 2][0] - s->lid[LID_UPPER][n / 2][0], s->lid[LID_LOWER][n / 2][1] - s->lid[LID_UPPER][n / 2][1]) : 0;
	return isfinite(gap) ? gap : 0;
}

void outlines_give(struct track_result *r, struct outlines *o)
{
	r->outline = o->seen;
	r->outlines = o->n;
	o->seen = 0;
	o->n = o->room = 0;
}

void outlines_pack(struct pack *p, struct outlines *o)
{
	long n = o->n;
	PACK(p, n);
	if (p->reading) {
		p->bad = p->bad || n < o->packed || o->n != o->packed || (size_t)(n - o->packed) > p->n;
		if (p->bad)
			return;
		if (n > o->room)
			o->seen = bulk_grow(o->bulk, o->seen, (size_t)(o->room = n), sizeof *o->seen);
	}
	if (n > o->packed)
		pack_bytes(p, o->seen + o->packed, (size_t)(n - o->packed) * sizeof *o->seen);
	o->n = o->packed = n;
	PACK(p, o->looked);
	PACK(p, o->gap);
	PACK(p, o->frames);
}

void outlines_free(struct outlines *o)
{
	if (!o)
		return;
	evidence_close(o->net);
	bulk_free(o->bulk, o->seen);
	free(o);
}
