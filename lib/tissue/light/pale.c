#include "tissue/light/pale.h"

#include <math.h>
#include <stdlib.h>

#include "image/photo/patch.h"
#include "math/vec.h"

/* Normal of the scleral sphere where it lies (u, v) semi-axes of the limbus from its middle, as the photograph shows it. With the eye
 * turned the ellipse is foreshortened and shifted: the sphere is met by the ray itself where there is a camera. */
static void normal_at(float normal[3], const struct fit *fit, const struct eye *eye, const double px[2])
{
	double o[3], d[3], back = sqrt(PALE_SCLERA_MM * PALE_SCLERA_MM - eye->limbus_radius * eye->limbus_radius);
	normal[0] = normal[1] = 0;
	normal[2] = -1;
	if (!(fit->camera.focal_px > 0) || !(fit->cam_from_eye[2][3] > 0))
		return;
	fit_ray(o, d, fit, px);
	double center[3] = { 0, 0, eye_limbus_depth(eye) + back };
	double q[3] = { o[0] - center[0], o[1] - center[1], o[2] - center[2] };
	double b = vec_dot(q, d), near = b * b - vec_dot(q, q) + PALE_SCLERA_MM * PALE_SCLERA_MM, t = -b - sqrt(fmax(near, 0));
	for (int i = 0; i < 3; i++) {
		normal[i] = 0;
		for (int j = 0; j < 3; j++)
			normal[i] += (float)(fit->cam_from_eye[i][j] * (q[j] + t * d[j]) / PALE_SCLERA_MM);
	}
}

static int by_light(const void *a, const void *b)
{
	const struct pale *s = a, *t = b;
	return (s->light > t->light) - (s->light < t->light);
}

static int by_redness(const void *a, const void *b)
{
	const struct pale *s = a, *t = b;
	return (s->redness > t->redness) - (s->redness < t->redness);
}

static int ring(struct pale s[PALE_MAX], const struct photo *photo, const struct fit *fit, const struct eye *eye, const struct evidence *evidence,
                const struct pale_conf *conf)
{
	const struct ellipse *e = &fit->limbus;
	double side = e->a * 0.006, c = cos(e->angle), d = sin(e->angle);
	int n = 0;
	for (int i = 0; i < PALE_MAX; i++) {
		double turn = 2 * M_PI * (i / PALE_ACROSS) / PALE_AROUND, rgb[3];
		double scale = conf->inner + (conf->outer - conf->inner) * (i % PALE_ACROSS + 0.5) / PALE_ACROSS;
		double u = scale * e->a * cos(turn), v = scale * e->b * sin(turn), px[2] = { e->cx + u * c - v * d, e->cy + u * d + v * c };
		if (evidence && (double)evidence_at(evidence, EVIDENCE_SCLERA, px[0], px[1]) < conf->sure)
			continue;
		if (!photo_patch(rgb, photo, px[0], px[1], side))
			continue;
		double light = 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
		if (!(light > 0.004))
			continue;
		s[n] = (struct pale){ { (float)rgb[0], (float)rgb[1], (float)rgb[2] }, (float)light, (float)log(rgb[0] / fmax(rgb[1], 1e-4)), (float)light, { 0 } };
		normal_at(s[n++].normal, fit, eye, px);
	}
	return n;
}

int pale_find(struct pale s[PALE_MAX], const struct photo *photo, const struct fit *fit, const struct eye *eye, const struct evidence *evidence,
              const struct pale_conf *conf)
{
	int n = ring(s, photo, fit, eye, evidence, conf), m = 0, pale = 0;
	qsort(s, (size_t)n, sizeof *s, by_light);
	float bright = n ? s[n * 9 / 10].light : 0;
	for (int i = 0; i < n; i++)
		if (s[i].light > conf->dark * bright)
			s[m++] = s[i];
	qsort(s, (size_t)m, sizeof *s, by_redness);
	while (pale < m && s[pale].redness < fmin(s[m / 50].redness + conf->redness, conf->reddest + conf->white))
		pale++;
	return pale;
}
