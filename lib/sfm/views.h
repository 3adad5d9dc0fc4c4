/* views: all pictures of a capture, in the order and with the cameras in which COLMAP gets them.
 */
#ifndef SFM_VIEWS_H
#define SFM_VIEWS_H
#include "base/stage.h"
#include "sfm/colmap/colmap.h"
#include "sfm/view.h"

struct views {
	struct view *v;                 // [n]: those in use first, then those that are left out
	int n, n_used;
	struct colmap_camera *cameras;  // [n_cameras], px of the pictures: initial values, which the mapper adjusts
	bool *has_focal;                // [n_cameras]: the focal length is measured or given, not guessed
	int n_cameras;
};

/* Reads the photographs of views/ and photos/ and frames of video/, and writes each as a picture for COLMAP: upright, at most
 * picture_px long, named by its content. Near-duplicates and files that cannot be decoded are left out with a reason.
 * Returns false, err set, when a folder cannot be read or a picture not be written. views_free in any case. */
bool views_gather(struct views *views, struct stage *stage, const struct calibrate_options *o, struct err *err);
void views_free(struct views *views);

/* True when no photograph of views/ is in use: frames of a video are all there is. */
bool views_are_video(const struct views *views);

#endif
