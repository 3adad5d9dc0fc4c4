#include "track/clip/aside.h"

#include <math.h>
#include <stdlib.h>

#include "base/mem.h"
#include "track/head/propose.h"

/* Score of a pair that is a face's; lead over the one in the picture as it is. Assumptions. */
static const double sure = 0.6, lead = 0.2;

/* The score of the clearest pair of eyes that lie side by side; 0: none. */
static double side_by_side(struct evidence_net *net, const uint8_t *rgb, int width, int height)
{
	struct head_eyes eyes;
	struct err none = { 0 };
	if (!head_propose(&eyes, net, rgb, width, height, &none))
		return 0;
	return fabs(eyes.eye[0][0] - eyes.eye[1][0]) > fabs(eyes.eye[0][1] - eyes.eye[1][1]) ? eyes.score : 0;
}

/* Turned by a quarter; which way does not matter: eyes look much the same upside down. */
static uint8_t *quarter(const uint8_t *rgb, int width, int height)
{
	uint8_t *out = mem_array(3 * (size_t)width * (size_t)height + 1, 1);
	for (int y = 0; y < width; y++)
		for (int x = 0; x < height; x++)
			for (int k = 0; k < 3; k++)
				out[3 * ((long)y * height + x) + k] = rgb[3 * ((long)(height - 1 - x) * width + y) + k];
	return out;
}

bool track_lies_aside(const struct track_clip *clip, struct err *err)
{
	struct evidence_net *net = 0;
	struct err none = { 0 };
	const int w = clip->info.width, h = clip->info.height;
	if (!clip->rgb || w < 1 || h < 1 || !evidence_open_shipped(&net, &none))
		return false;
	uint8_t *turned = quarter(clip->rgb, w, h);
	const double upright = side_by_side(net, clip->rgb, w, h), aside = side_by_side(net, turned, h, w);
	free(turned);
	evidence_close(net);
	if (!(aside > sure && aside > upright + lead))
		return false;
	*err = (struct err){ 0 };
	return err_set(err, "%s: frame %ld lies on its side, its eyes one above the other: set the file's rotation, or turn the film (ffmpeg -i IN -vf transpose=1 OUT; 2: the other way), and width and height of the camera's keys with it",
	               clip->file, clip->reference);
}
