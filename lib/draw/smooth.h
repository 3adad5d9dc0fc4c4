/* smooth: the cubic step between two edges (smoothstep). */
#ifndef DRAW_SMOOTH_H
#define DRAW_SMOOTH_H

/* 0 below lo, 1 above hi; between them 3 t^2 - 2 t^3, without a slope at either end. */
static inline float smooth(float lo, float hi, float x)
{
	float t = (x - lo) / (hi - lo);
	t = t > 0 ? t < 1 ? t : 1 : 0;
	return t * t * (3 - 2 * t);
}

#endif
