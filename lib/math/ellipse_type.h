/* ellipse_type: an ellipse by centre, semi-axes and angle. Apart from ellipse.h because C++ can include it. */
#ifndef MATH_ELLIPSE_TYPE_H
#define MATH_ELLIPSE_TYPE_H

/* Centre and semi-axes a >= b, px; angle of the major axis from +x towards +y, radians. */
struct ellipse {
	double cx, cy, a, b, angle;
};

#endif
