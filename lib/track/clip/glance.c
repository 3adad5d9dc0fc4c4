#include "track/clip/glance.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/mem.h"
#include "limbus/evidence.h"
#include "track/head/propose.h"

struct glance {
	const struct track_clip *clip;
	const struct track_subject *subject;
	double limbus;                 // mm, of an average eye
	double evidence_px;            // conf's
	struct evidence_net *net;
	struct photo photo;            // what lies round the eyes
	struct evidence seen[SIDES];   // of the last frame
};

/* Middle and radius of an iris that looks straight on, px. */
static bool iris_of(double place[3], const struct glance *g, int side, const double pose[4][4])
{
	const struct track_subject *s = g->subject;
	const double limbus = s->limbus[side] > 0 ? s->limbus[side] : g->limbus;
	double p[3];
	if (!s->opening[side].open || !head_project(place, &g->clip->camera, pose, s->opening[side].center))
		return false;
	head_from(p, pose, s->opening[side].center);
	place[2] = g->clip->camera.focal_px * limbus / p[2];
	return place[2] > 0;
}

static int within(double x, int size)
{
	return (int)fmin(fmax(x, 0), size);
}

/* What the network is shown of an iris. */
static void fill_photo(struct photo *photo, const uint8_t *rgb, const double place[3])
{
	const double reach = 0.5 * EVIDENCE_GLANCE_WIDE / EVIDENCE_GLANCE * place[2] + 2;
	const int x0 = within(place[0] - reach, photo->width), x1 = within(place[0] + reach, photo->width), y0 = within(place[1] - reach, photo->height), y1 = within(place[1] + reach, photo->height);
	for (int y = y0; y < y1; y++)
		for (long i = 3 * ((long)y * photo->width + x0); i < 3 * ((long)y * photo->width + x1); i++)
			photo->rgb[i] = (uint16_t)(257 * rgb[i]);
}

void glance_tell(struct glance_told *t, const struct eye_frame *frame, const struct glance *g)
{
	const struct track_subject *s = g->subject;
	*t = (struct glance_told){ .radius = 0 };
	for (int e = 0; e < SIDES; e++) {
		double place[3], from[2], to[2];
		if (!frame->evidence[e] || !iris_of(place, g, e, frame->cam_from_head) || !head_project(from, &g->clip->camera, frame->cam_from_head, s->opening[e].canthus[0])
		    || !head_project(to, &g->clip->camera, frame->cam_from_head, s->opening[e].canthus[1]))
			continue;
		const double wide = fmax(1e-9, hypot(to[0] - from[0], to[1] - from[1])), across[2] = { (to[0] - from[0]) / wide, (to[1] - from[1]) / wide };
		if (eye_told_of(&t->told[e], frame->evidence[e], place, across))
			t->known[e] = &t->told[e];
		t->radius = place[2];
	}
}

void glance_at(struct eye_frame *frame, struct glance *g, const bool in[SIDES])
{
	double place[SIDES][3];
	int side[SIDES], n = 0;
	struct evidence seen[SIDES];
	struct err none = { 0 };
	for (int e = 0; e < SIDES; e++) {
		evidence_free(&g->seen[e]);
		if (!in[e] || !iris_of(place[n], g, e, frame->cam_from_head) || !(g->subject->assumed || place[n][2] < g->evidence_px))
			continue;
		fill_photo(&g->photo, frame->rgb, place[n]);
		side[n++] = e;
	}
	// a network that does not run says so where the reference is looked for
	if (!n || !evidence_glance(seen, n, (const double(*)[3])place, g->net, &g->photo, &none))
		return;
	for (int i = 0; i < n; i++) {
		g->seen[side[i]] = seen[i];
		frame->evidence[side[i]] = &g->seen[side[i]];
	}
}

struct glance *glance_new(const struct track_clip *clip, const struct track_subject *subject, const struct track_conf *conf)
{
	struct glance *g = mem_new(1, sizeof *g);
	struct err none = { 0 };
	*g = (struct glance){ .clip = clip, .subject = subject, .limbus = conf->eye.limbus_radius, .evidence_px = conf->eyes.evidence_px };
	bool wanted = subject->assumed && g->evidence_px > 0;
	for (int e = 0; e < SIDES; e++) {
		double place[3];
		wanted = wanted || (clip->eye_seen[e] && iris_of(place, g, e, clip->cam_from_head) && place[2] < g->evidence_px);
	}
	if (!wanted || !evidence_open_shipped(&g->net, &none)) {
		free(g);
		return 0;
	}
	g->photo = (struct photo){ .width = clip->info.width, .height = clip->info.height, .bits = 8,
		.rgb = mem_new(3 * (size_t)clip->info.width * (size_t)clip->info.height, sizeof *g->photo.rgb) };
	return g;
}

void glance_free(struct glance *g)
{
	if (!g)
		return;
	for (int e = 0; e < SIDES; e++)
		evidence_free(&g->seen[e]);
	evidence_close(g->net);
	free(g->photo.rgb);
	free(g);
}

bool glance_find(double eye[SIDES][2], struct glance *g, const uint8_t *rgb)
{
	struct head_eyes found;
	struct err none = { 0 };
	const bool any = head_propose(&found, g->net, rgb, g->clip->info.width, g->clip->info.height, &none);
	if (any)
		memcpy(eye, found.eye, sizeof found.eye);
	return any;
}
