#include <math.h>
#include <string.h>

#include "math/vec.h"
#include "sfm/colmap/colmap.h"

bool colmap_to_camera(struct camera *out, double focal[2], const struct colmap_camera *camera, struct err *err)
{
	const double *p = camera->params;
	*out = (struct camera){ .source = CAMERA_RIG };
	bool two = camera->kind == COLMAP_PINHOLE || camera->kind == COLMAP_OPENCV || camera->kind == COLMAP_FULL_OPENCV;
	focal[0] = p[0];
	focal[1] = two ? p[1] : p[0];
	out->focal_px = sqrt(focal[0] * focal[1]);
	out->center_px[0] = p[two ? 2 : 1];
	out->center_px[1] = p[two ? 3 : 2];
	switch (camera->kind) {
	case COLMAP_SIMPLE_PINHOLE:
	case COLMAP_PINHOLE:
		return true;
	case COLMAP_SIMPLE_RADIAL:
	case COLMAP_RADIAL:
		memcpy(out->distortion, p + 3, (camera->kind == COLMAP_RADIAL ? 2 : 1) * sizeof *p);
		return true;
	case COLMAP_FULL_OPENCV:
		// k1 k2 p1 p2 k3, then the denominator k4 k5 k6
		if (p[9] || p[10] || p[11])
			break;
		memcpy(out->distortion, p + 4, 5 * sizeof *p);
		return true;
	case COLMAP_OPENCV:
		memcpy(out->distortion, p + 4, 4 * sizeof *p);
		return true;
	default:
		break;
	}
	return err_set(err, "camera %u: %s: a lens of this kind is not supported", camera->id, colmap_kind_name(camera->kind));
}

void colmap_rotation(double R[3][3], const double q[4])
{
	double w = q[0], x = q[1], y = q[2], z = q[3];
	R[0][0] = 1 - 2 * (y * y + z * z);
	R[0][1] = 2 * (x * y - z * w);
	R[0][2] = 2 * (x * z + y * w);
	R[1][0] = 2 * (x * y + z * w);
	R[1][1] = 1 - 2 * (x * x + z * z);
	R[1][2] = 2 * (y * z - x * w);
	R[2][0] = 2 * (x * z - y * w);
	R[2][1] = 2 * (y * z + x * w);
	R[2][2] = 1 - 2 * (x * x + y * y);
}

void colmap_center(double center[3], const struct colmap_image *image)
{
	double R[3][3];
	colmap_rotation(R, image->q);
	mat_tvec(center, R, image->t);
	for (int i = 0; i < 3; i++)
		center[i] = -center[i];
}

/* Reprojection error, px. Some camera models have two focal lengths, camera_project has one: the projection is scaled by their
 * ratio. */
static double distance(const struct colmap_image *image, const double R[3][3], const struct camera *camera,
                       const double focal[2], const struct colmap_seen *seen, const double xyz[3])
{
	double p[3], px[2];
	mat_vec(p, R, xyz);
	for (int i = 0; i < 3; i++)
		p[i] += image->t[i];
	if (!camera_project(px, camera, p))
		return NAN;
	for (int i = 0; i < 2; i++)
		px[i] = camera->center_px[i] + (px[i] - camera->center_px[i]) * focal[i] / camera->focal_px;
	return hypot(px[0] - seen->px[0], px[1] - seen->px[1]);
}

static double residual_sum(long *n, const struct colmap_model *model, const struct colmap_image *image)
{
	struct camera camera;
	struct err none = { 0 };
	double focal[2], R[3][3], sum = 0;
	if (!colmap_to_camera(&camera, focal, &model->cameras[image->camera], &none))
		return NAN;
	colmap_rotation(R, image->q);
	for (int k = 0; k < image->n_seen; k++)
		if (image->seen[k].point >= 0) {
			sum += distance(image, R, &camera, focal, &image->seen[k], model->points[image->seen[k].point].xyz);
			++*n;
		}
	return sum;
}

double colmap_residual(const struct colmap_model *model, int i)
{
	double sum = 0;
	long n = 0;
	for (int k = i < 0 ? 0 : i; k < (i < 0 ? model->n_images : i + 1); k++)
		sum += residual_sum(&n, model, &model->images[k]);
	return n ? sum / (double)n : NAN;
}

bool colmap_check_errors(const struct colmap_model *model, const char *where, struct err *err)
{
	for (int i = 0; i < model->n_points; i++) {
		const struct colmap_point *p = &model->points[i];
		double sum = 0;
		for (int k = 0; k < p->n_track && p->error >= 0; k++) {
			const struct colmap_image *image = &model->images[p->track[k].image];
			struct camera camera;
			double focal[2], R[3][3];
			if (!colmap_to_camera(&camera, focal, &model->cameras[image->camera], err))
				return err_wrap(err, "%s", where);
			colmap_rotation(R, image->q);
			sum += distance(image, R, &camera, focal, &image->seen[p->track[k].seen], p->xyz);
		}
		double got = p->n_track ? sum / p->n_track : 0;
		if (p->error >= 0 && !(fabs(got - p->error) <= 1e-6 * (1 + p->error)))
			return err_set(err, "%s: point %llu: its error is %.9g px, the file says %.9g: bytes have changed, or the files "
			               "are of two models", where, (unsigned long long)p->id, got, p->error);
	}
	return true;
}
