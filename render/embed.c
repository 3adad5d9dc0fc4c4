#include "render/embed.h"

/* C23's #embed is newer than the compilers; .incbin is in both their assemblers. Paths are the repository's. */
#define EMBED(name, file) \
	__asm__(".section .rodata\n.global " #name "\n" #name ":\n.incbin \"render/" file "\"\n.byte 0\n.previous\n")

EMBED(page_html, "page.html");
EMBED(page_css, "page.css");
EMBED(page_js, "page.js");
