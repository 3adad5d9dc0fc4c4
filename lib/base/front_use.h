/* front_use: the choice of settings on its way from plan to the stages, in the capture's work/.made/front. */
#ifndef BASE_FRONT_USE_H
#define BASE_FRONT_USE_H
#include "base/front.h"

/* Writes the choice of front_choose() for n stages. The file is replaced only when its bytes change: *changed. Returns false, err
 * set, when it cannot be written. */
bool front_save(const struct front *front, const struct front_ask *ask, int n, const int chosen[], const char *capture,
                bool *changed, struct err *err);

/* Adds the chosen settings of this stage to conf, which is loaded already, with precedence over its defaults. Does nothing when
 * neither an error nor a time is asked for. Returns false, err set, when plan has not made its choice. */
bool front_apply(struct conf *conf, const char *stage, const char *capture, const char *config_dir, struct err *err);

#endif
