/* fill: what no photograph saw of the iris, continued from what was seen. */
#ifndef DRAW_EYE_FILL_H
#define DRAW_EYE_FILL_H

/* RGB [n][n][4] with weight in A (0: no photograph saw it): what is missing is continued round the axis from what was
 * seen at the same radius, so that fibres go on. pupil: x, y, radius. */
void scene_fill(float *rgba, int n, double extent, const double pupil[3]);

#endif
