/* front_use: the choice of settings on its way from plan to the stages, in the capture's work/.made/front. */
#ifndef BASE_FRONT_USE_H
#define BASE_FRONT_USE_H
#include "base/front.h"

/* The choice, for the stages. Written only when it differs: *changed. */
bool front_save(const struct front *front, const struct front_ask *ask, int n, const int chosen[], const char *capture,
                bool *changed, struct err *err);

/* Puts the chosen settings of this stage before the defaults of conf, which has been loaded already. Nothing when
 * neither error nor time is asked for. False, err set, when plan has not chosen yet. */
bool front_apply(struct conf *conf, const char *stage, const char *capture, const char *config_dir, struct err *err);

#endif
