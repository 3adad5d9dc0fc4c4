/* sensor: how wide the sensors of cameras are that do not say it in EXIF themselves. */
#ifndef OPTICS_SENSOR_H
#define OPTICS_SENSOR_H

/* Focal length, px, of a whole picture of that camera with that focal length, mm; longer: its longer side, px. NAN where one of
 * them is not known. */
double sensor_focal_px(const char *model, double focal_mm, int longer);

#endif
