/* The page's own text, put into the program by the assembler (render/page.html, page.css, page.js). */
#ifndef RENDER_EMBED_H
#define RENDER_EMBED_H

extern const char page_html[], page_css[], page_js[];  // end with a zero byte

#endif
