#include "optics/refraction/table.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "optics/lightpath/path.h"

/* The paper's table: radius of P × angle of w from the axis × azimuth. Reflection maps an azimuth to its negative, so half a
 * circle is stored, which makes the paper's table twice as fine as printed. */

static float *sample(const struct refraction *f, int point, int theta, int phi)
{
	return f->data[((long)point * f->thetas + theta) * f->phis + phi];
}

void refraction_tabulate(struct refraction *f)
{
	f->n_data = (long)f->points * f->thetas * f->phis;
	free(f->data);
	f->data = mem_new(f->n_data, sizeof *f->data);
#pragma omp parallel for
	for (int point = 0; point < f->points; point++) {
		for (int i = 0; i < f->thetas * f->phis; i++) {
			double theta = M_PI / 2 * (i / f->phis) / (f->thetas - 1), phi = M_PI * (i % f->phis) / (f->phis - 1);
			double P[3] = { f->radius * point / (f->points - 1), 0, f->depth }, K[3];
			double w[3] = { sin(theta) * cos(phi), sin(theta) * sin(phi), -cos(theta) };
			path_shortest(K, &(struct path){ &f->cornea, P, 0, w });
			for (int k = 0; k < 3; k++)
				sample(f, point, i / f->phis, i % f->phis)[k] = K[k];
		}
	}
}

/* Position of a value 0..1 among n samples: *low, the lower sample; returns the weight of the upper one. nearest: rounded, weight
 * 0. */
static float place(int *low, double u, int n, bool nearest)
{
	double at = fmin(fmax(u, 0), 1) * (n - 1);
	*low = fmin(nearest ? floor(at + 0.5) : floor(at), n - 2 + nearest);
	return nearest ? 0 : at - *low;
}

static void look_up(float K[3], const struct refraction *f, double r, double theta, double phi)
{
	bool nearest = f->method == REFRACTION_TABLE_NEAREST;
	int i, j, k, more = nearest ? 1 : 2;
	float u = place(&i, r / f->radius, f->points, nearest), v = place(&j, theta / (M_PI / 2), f->thetas, nearest);
	float s = place(&k, phi / M_PI, f->phis, nearest);
	K[0] = K[1] = K[2] = 0;
	for (int corner = 0; corner < more * more * more; corner++) {
		int a = corner % more, b = corner / more % more, c = corner / more / more;
		float weight = (a ? u : 1 - u) * (b ? v : 1 - v) * (c ? s : 1 - s);
		const float *at = sample(f, i + a, j + b, k + c);
		for (int q = 0; q < 3; q++)
			K[q] += weight * at[q];
	}
}

void refraction_look_up(const struct refraction *f, int n, const float *px, const float *py, const float *wx,
                        const float *wy, const float *wz, float *kx, float *ky, float *kz)
{
	for (int i = 0; i < n; i++) {
		float r = hypotf(px[i], py[i]), ex = r > 0 ? px[i] / r : 1, ey = r > 0 ? py[i] / r : 0;
		float along = wx[i] * ex + wy[i] * ey, across = wy[i] * ex - wx[i] * ey, K[3];
		look_up(K, f, r, acosf(fminf(1, -wz[i])), atan2f(fabsf(across), along));
		float side = across < 0 ? -K[1] : K[1];
		kx[i] = K[0] * ex - side * ey;
		ky[i] = K[0] * ey + side * ex;
		kz[i] = K[2];
	}
}
