#include "track/clip/scale.h"

double track_px_per_mm(const struct track_clip *clip, const double cam_from_head[4][4], const struct track_subject *s)
{
	return clip->camera.focal_px / track_eyes_depth(cam_from_head, s);
}
