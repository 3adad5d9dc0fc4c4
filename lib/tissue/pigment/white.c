#include "tissue/pigment/white.h"

#include <math.h>
#include <stdlib.h>

#include "image/photo/patch.h"
#include "tissue/light/sclera_light.h"

const char *const white_names[] = { "camera", "sclera", "card", 0 };

struct white white_camera(void)
{
	return (struct white) { .rgb = { 1, 1, 1 }, .source = WHITE_CAMERA, .spread = 0.5 };
}

bool white_better(const struct white *a, const struct white *b)
{
	return a->source > b->source || (a->source == b->source && a->share > b->share);
}

bool white_card(struct white *out, const struct photo *photo, const double disc[3], const struct white_conf *conf,
                struct err *err)
{
	*out = (struct white) { .source = WHITE_CARD, .share = 1, .spread = 0.02 };
	if (!photo_patch(out->rgb, photo, disc[0], disc[1], disc[2] / sqrt(2)))
		return err_set(err, "card at (%g, %g), radius %g px: outside the photograph or over-exposed", disc[0], disc[1], disc[2]);
	for (int c = 0; c < 3; c++)
		out->rgb[c] /= conf->card;
	return true;
}

static double luminance(const double rgb[3])
{
	return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

double white_level(const struct white *white, bool told, const struct white_conf *conf)
{
	const double level = luminance(white->sclera) / luminance(conf->sclera), most = conf->shade_most, by = white->shade > 0 ? -log(white->shade) : 0;
	return !(level > 0) ? 1 : told ? level : level * exp((most > 0 ? most * tanh(by / most) : 0) - by);
}

double white_level_sigma(const struct white *white, bool told)
{
	const double people = 0.12, shade = !told && white->shade > 0 ? log(white->shade) : 0;
	return white->sclera[1] > 0 ? hypot(people, shade / 2) : NAN;
}

static int by_light(const void *a, const void *b)
{
	const struct pale *s = a, *t = b;
	return (s->light > t->light) - (s->light < t->light);
}

/* The mean of the brighter half of the sclera is taken, which the lids shade as little as the iris. */
bool white_sclera(struct white *out, struct pale s[], int n, const struct envmap *env, const struct white_conf *conf)
{
	enum { LIGHTS = 128 };
	struct envmap_light light[LIGHTS];
	int lights = envmap_lights_spread(light, LIGHTS, env);
	*out = white_camera();
	if (!(n > conf->share_min * PALE_MAX))
		return false;
	for (int i = 0; i < n; i++) {
		float here[3];
		sclera_light_at(here, light, lights, s[i].normal);
		for (int c = 0; c < 3; c++)
			s[i].rgb[c] /= fmaxf(here[c], 0.02f);
		s[i].light = 0.2126f * s[i].rgb[0] + 0.7152f * s[i].rgb[1] + 0.0722f * s[i].rgb[2];
	}
	qsort(s, (size_t)n, sizeof *s, by_light);
	int low = n / 2, high = n - n / 20, k = high - low;
	double sum[3] = { 0 }, own = 0;
	for (int i = low; i < high; i++) {
		own += s[i].shown / k;
		for (int c = 0; c < 3; c++)
			sum[c] += s[i].rgb[c] / k;
	}
	*out = (struct white) { .source = WHITE_SCLERA, .share = (double)n / PALE_MAX };
	for (int c = 0; c < 3; c++) {
		out->rgb[c] = sum[c] / conf->sclera[c];
		out->sclera[c] = conf->sclera[c];
	}
	out->shade = own / luminance(sum);
	out->spread = log(s[high - 1].light / s[low].light) / 2;
	return true;
}
