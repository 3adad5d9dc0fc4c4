/* planes: the channels of a picture as layers of a network hand them on.
 * Rows lie `pitch` floats apart, with `border` zeros behind each, which stand before the next as well, and `border` rows of zeros above and below:
 * a convolution reads beyond the picture's edges without asking, and all its rows as one.
 */
#ifndef NET_PLANES_H
#define NET_PLANES_H
#include <stddef.h>

struct net_size { int channels, height, width; };

struct net_planes {
	struct net_size size;
	int border;
	long pitch, plane;  // floats from a row to the next, from a plane to the next
	float *px;          // the first pixel of the first plane; what lies around it belongs to it
};

/* Floats read beyond a picture's last one by loads of whole vectors, at most. */
enum { NET_PLANES_BEYOND = 64 };

/* How many floats a picture takes, borders and what is read beyond it counted. */
size_t net_planes_floats(struct net_size size, int border);

/* A picture in `floats` (net_planes_floats; not owned): borders are zero, pixels are not set. */
struct net_planes net_planes_in(float *floats, struct net_size size, int border);

/* Sets what lies behind each row to zero again. */
void net_planes_seal(const struct net_planes *p, int channel);

float *net_planes_row(const struct net_planes *p, int channel, int row);

#endif
