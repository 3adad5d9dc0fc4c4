/* sensor: sensor sizes of cameras whose EXIF does not state them. */
#ifndef OPTICS_SENSOR_H
#define OPTICS_SENSOR_H

/* Focal length in px of an uncropped picture.
 * model     the camera's name in EXIF ("Canon EOS 600D")
 * focal_mm  focal length, mm
 * longer    longer side of the picture, px
 * Returns NAN where the camera is not in the table or focal_mm is NAN. */
double sensor_focal_px(const char *model, double focal_mm, int longer);

#endif
