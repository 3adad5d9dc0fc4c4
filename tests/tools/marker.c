/* marker: lays a printed marker into photographs whose cameras are known, for the scripts of tests/chain.
 *
 *     marker RIG VIEWS SIDE_MM X Y Z
 * RIG: rig.json of the capture. VIEWS: folder in which each of its photographs is replaced. The marker's black square lies
 * round X Y Z of the head's frame, facing +z.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/file.h"
#include "base/mem.h"
#include "bridge/cv_marker.h"
#include "image/picture.h"
#include "math/vec.h"
#include "optics/camera_rig.h"

enum { SIZE = 800, FAMILY = 2, ID = 17, SAMPLES = 3 };
/* cv_marker_draw leaves an eighth of its side white on each side. */
static const double black_share = 0.75;

/* Marker seen along a pixel's ray: its grey, or -1 beside it. */
static int seen(const struct rig_camera *c, double x, double y, const double middle[3], double side, const uint8_t *marker)
{
	double ray[3], origin[3], dir[3], R[3][3], t[3];
	camera_ray(ray, &c->camera, (double[]){ x, y });
	for (int i = 0; i < 3; i++) {
		for (int k = 0; k < 3; k++)
			R[i][k] = c->cam_from_head[i][k];
		t[i] = -c->cam_from_head[i][3];
	}
	mat_tvec(origin, R, t);
	mat_tvec(dir, R, ray);
	double s = (middle[2] - origin[2]) / dir[2], whole = side / black_share;
	double u = (origin[0] + s * dir[0] - middle[0]) / whole + 0.5, v = 0.5 - (origin[1] + s * dir[1] - middle[1]) / whole;
	if (!(s > 0 && u >= 0 && v >= 0 && u < 1 && v < 1))
		return -1;
	return marker[(int)(v * SIZE) * SIZE + (int)(u * SIZE)];
}

static bool lay(const struct rig_camera *c, const char *path, const double middle[3], double side, const uint8_t *marker, struct err *err)
{
	uint8_t *px, *jpeg = 0;
	int w, h;
	size_t size;
	if (!picture_read(&px, &w, &h, path, 200, err))
		return false;
#pragma omp parallel for
	for (int y = 0; y < h; y++)
		for (int x = 0; x < w; x++) {
			int sum = 0;
			for (int k = 0; k < SAMPLES * SAMPLES && sum >= 0; k++) {
				int grey = seen(c, x + (k % SAMPLES + 0.5) / SAMPLES, y + (k / SAMPLES + 0.5) / SAMPLES, middle, side, marker);
				sum = grey < 0 ? -1 : sum + grey;
			}
			for (int k = 0; k < 3 && sum >= 0; k++)
				px[3 * ((long)y * w + x) + k] = (uint8_t)(sum / (SAMPLES * SAMPLES));
		}
	bool ok = picture_jpeg_encode(&jpeg, &size, px, w, h, 3, 95, err) && file_write(path, jpeg, size, err);
	free(px);
	free(jpeg);
	return ok;
}

int main(int argc, char **argv)
{
	struct camera_rig rig = { 0 };
	struct err err = { 0 };
	static uint8_t marker[SIZE * SIZE];
	if (argc != 7) {
		fprintf(stderr, "marker: RIG VIEWS SIDE_MM X Y Z\n");
		return 2;
	}
	const double middle[3] = { atof(argv[4]), atof(argv[5]), atof(argv[6]) };
	bool ok = camera_rig_load(&rig, argv[1], &err) && cv_marker_draw(marker, SIZE, FAMILY, ID, &err);
	for (int i = 0; i < rig.n && ok; i++) {
		char *path = mem_printf("%s/%s.jpg", argv[2], rig.cameras[i].name);
		ok = lay(&rig.cameras[i], path, middle, atof(argv[3]), marker, &err);
		free(path);
	}
	camera_rig_free(&rig);
	if (!ok)
		fprintf(stderr, "marker: %s\n", err.msg);
	return !ok;
}
