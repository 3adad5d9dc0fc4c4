/* Which of the environment's directions share a beam. */
#include "draw/eye/march/march.h"
#include "math/vec.h"

void scene_lights_turn(struct beam_lights *in, const struct scene_lighting *light, const double eye_from_cam[3][3])
{
	in->n = 0;
	for (int i = 0; i < light->n; i++) {
		const struct envmap_light *l = &light->light[i];
		double d[3] = { l->dir[0], l->dir[1], l->dir[2] };
		mat_vec(d, eye_from_cam, d);
		if (d[2] > 0.16)  // further than about 99 degrees from the axis: no path leads into the eye
			continue;
		for (int c = 0; c < 3; c++) {
			in->dir[in->n][c] = (float)d[c];
			in->rgb[in->n][c] = l->rgb[c];
		}
		in->share[in->n++] = 0.2126f * l->rgb[0] + 0.7152f * l->rgb[1] + 0.0722f * l->rgb[2];
	}
}

/* Weighted variance of a beam's lights along the worse of the axes x and y; its mean there. */
static float spread(const struct beam_lights *in, int *axis, float *mean)
{
	float all = 0, first[2] = { 0 }, second[2] = { 0 }, most = -1;
	for (int i = 0; i < in->n; i++) {
		all += in->share[i];
		for (int c = 0; c < 2; c++) {
			first[c] += in->share[i] * in->dir[i][c];
			second[c] += in->share[i] * in->dir[i][c] * in->dir[i][c];
		}
	}
	for (int c = 0; c < 2; c++) {
		float off = second[c] - first[c] * first[c] / all;
		if (off > most) {
			most = off;
			*axis = c;
			*mean = first[c] / all;
		}
	}
	return most;
}

/* Moves the lights of one beam beyond the mean of its worse axis into another. */
static void split(struct beam_lights *in, struct beam_lights *out)
{
	int axis = 0, left = 0;
	float mean = 0;
	spread(in, &axis, &mean);
	out->n = 0;
	for (int i = 0; i < in->n; i++) {
		struct beam_lights *to = in->dir[i][axis] > mean ? out : in;
		int k = to == in ? left++ : out->n++;
		for (int c = 0; c < 3; c++) {
			to->dir[k][c] = in->dir[i][c];
			to->rgb[k][c] = in->rgb[i][c];
		}
		to->share[k] = in->share[i];
	}
	in->n = left;
}

int scene_lights_split(struct beam_lights *in, int most)
{
	int n = in->n > 0;
	while (n && n < most) {
		int axis, at = 0;
		float wide = 1e-6f, mean;
		for (int i = 0; i < n; i++) {
			float w = in[i].n > 1 ? spread(&in[i], &axis, &mean) : 0;
			at = w > wide ? i : at;
			wide = w > wide ? w : wide;
		}
		if (!(wide > 1e-6f))
			break;
		split(&in[at], &in[n++]);
	}
	return n;
}
