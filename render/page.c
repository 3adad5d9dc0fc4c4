#include "render/render.h"
bool page_make(struct stage *stage, const struct capture *capture, struct err *err)
{
	(void)stage; (void)capture; (void)err;
	return true;
}
