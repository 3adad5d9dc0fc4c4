/* halves PICTURE.png: red, green and blue of the left third of a picture and of the right one, in the mean of their pixels, linear. */
#include <stdio.h>
#include <stdlib.h>

#include "image/photo/photo.h"

int main(int argc, char **argv)
{
	struct photo photo;
	struct err err = { 0 };
	if (argc != 2 || !photo_load(&photo, argv[1], 100, &err)) {
		fprintf(stderr, "halves: %s\n", argc == 2 ? err.msg : "PICTURE.png");
		return 2;
	}
	struct image image = photo_linear(&photo, 0, 0, photo.width, photo.height);
	const int third = image.width / 3;
	for (int side = 0; side < 2; side++) {
		double sum[3] = { 0 };
		for (int y = 0; y < image.height; y++)
			for (int x = 0; x < third; x++)
				for (int c = 0; c < 3; c++)
					sum[c] += (double)image_at(&image, side ? image.width - 1 - x : x, y)[c];
		for (int c = 0; c < 3; c++)
			printf("%.4f%c", sum[c] / third / image.height, c < 2 || !side ? ' ' : '\n');
	}
	image_free(&image);
	photo_free(&photo);
	return 0;
}
