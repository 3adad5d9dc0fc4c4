/* altered: a photograph mirrored, turned, cropped, shrunk, under other light or longer exposed, and where an ellipse of it then lies. */
#ifndef TESTS_UNSEEN_ALTERED_H
#define TESTS_UNSEEN_ALTERED_H
#include "tests/lib/unseen/unseen.h"

enum { ALTERED_MIRRORED, ALTERED_TURNED, ALTERED_CROPPED, ALTERED_HALF, ALTERED_LIGHT, ALTERED_EXPOSED, ALTERED_KINDS };
extern const char *const altered_kind[ALTERED_KINDS];

/* kind: as above; amount: radians; share of the crop that is left over beside the eye, 0..1; kelvin of the light, the photograph taken
 * to be balanced for 6500; stops. */
struct altered { int kind; double amount; };

/* All that are tried: mirrored, 23 turns of 15 degrees, two crops, half size, four lights, two exposures. */
enum { ALTERED_ALL = 33 };
struct altered altered_all(int i);

/* A changed copy (photo_free); about: the eye's limbus, which stays in the frame. */
struct photo altered_photo(const struct photo *photo, const struct altered *how, const struct ellipse *about);
/* Where the ellipse e of the photograph lies in the changed copy. */
struct ellipse altered_ellipse(const struct ellipse *e, const struct photo *photo, const struct altered *how, const struct ellipse *about);

#endif
