/* skin_cameras: views of a person's face and their cameras, as calibrate left them. Apart from skin_views, as a rig has a rig_camera of its own.
 * Frame  head: the subject mesh's axes, x to the person's left, y up, z out of the face; mm.
 */
#ifndef RENDER_FACE_SKIN_CAMERAS_H
#define RENDER_FACE_SKIN_CAMERAS_H
#include "base/stage.h"
#include "optics/camera.h"

struct face_camera {
	char *file;                  // "views/a.jpg"; owned
	int width, height;           // px that camera is of
	struct camera camera;
	double cam_from_head[4][4];  // mm
	double way[3];               // from between the eyes to it, head, unit
};

/* At most so many photographs of views/ from before the face: the most frontal first, then each time the one that lies furthest from those taken. Returns how many; 0, err set, where
 * there is none. skin_cameras_free */
int skin_cameras(struct face_camera *out, int most, struct stage *stage, struct err *err);
void skin_cameras_free(struct face_camera *cameras, int n);

#endif
