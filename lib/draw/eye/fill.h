/* fill: inpaints what the texture of an iris lacks. */
#ifndef DRAW_EYE_FILL_H
#define DRAW_EYE_FILL_H

/* Continues the texture round the pupil's centre from what was seen at the same radius, and outwards along the same angle, so
 * that fibres go on.
 * rgba    [n][n][4], in place: linear colour, weight in A (0: no photograph saw it; a colour there is one that was filled in, and stays)
 * extent  half-width of the map, mm; pupil: x, y, radius, mm
 * A map that no photograph saw at all becomes grey. */
void scene_fill(float *rgba, int n, double extent, const double pupil[3]);

#endif
