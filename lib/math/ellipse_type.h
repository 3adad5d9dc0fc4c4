/* ellipse_type: an ellipse as people read it. Apart from ellipse.h, so that bridges can name it too. */
#ifndef MATH_ELLIPSE_TYPE_H
#define MATH_ELLIPSE_TYPE_H

/* px; a >= b semi-axes; angle of the major axis from +x towards +y, radians in memory. */
struct ellipse {
	double cx, cy, a, b, angle;
};

#endif
