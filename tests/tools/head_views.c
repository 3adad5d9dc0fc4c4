/* head_views DIR N WIDTH HEIGHT: N photographs of the drawn head into DIR, from all round its face at two heights; the number
 * of each camera and its place, mm, to standard output.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/mem.h"
#include "image/picture.h"
#include "math/vec.h"
#include "tests/lib/scenes/drawn_head.h"

int main(int argc, char **argv)
{
	struct drawn_head head;
	struct err err = { 0 };
	const int n = argc == 5 ? atoi(argv[2]) : 0, w = n ? atoi(argv[3]) : 0, h = n ? atoi(argv[4]) : 0;
	if (n < 2 || w < 100 || h < 100) {
		fprintf(stderr, "head_views DIR N WIDTH HEIGHT\n");
		return 2;
	}
	uint8_t *rgb = mem_new((size_t)w * (size_t)h * 3, 1);
	bool ok = drawn_head_load(&head, &err);
	for (int i = 0; i < n && ok; i++) {
		double R[3][3], t[3], c[3];
		char *path = mem_printf("%s/%03d.png", argv[1], i);
		drawn_head_camera(R, t, (2.0 * i / (n - 1) - 1) * 1.2, i % 2 ? 0.2 : -0.1, 600);
		drawn_head_draw(rgb, &head, R, t, 1.7 * h, w, h);
		mat_tvec(c, R, t);
		printf("%03d %.4f %.4f %.4f\n", i, -c[0], -c[1], -c[2]);
		ok = picture_png_write(path, rgb, w, h, 3, &err);
		free(path);
	}
	if (!ok)
		fprintf(stderr, "%s\n", err.msg);
	else
		drawn_head_free(&head);
	free(rgb);
	return !ok;
}
