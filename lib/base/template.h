/* template: text with placeholders, filled from a JSON object, in the manner of Mustache:
 *     {{key}}              the value, escaped for HTML text and attributes
 *     {{&key}}             the value unescaped: for HTML of our own
 *     {{#key}} .. {{/key}} once for each element of an array; once for an object, a true value or a text that is not
 *                          empty; inside, keys are looked up in the element first, then outwards; {{.}} is the element
 *     {{^key}} .. {{/key}} once where {{#key}} would give nothing
 * Numbers are written with %.6g; a key that is not there is empty.
 */
#ifndef BASE_TEMPLATE_H
#define BASE_TEMPLATE_H
#include <jansson.h>
#include <stddef.h>

#include "base/err.h"

/* Fills the template `text`. *out: free(); *size: its bytes. Returns false, err set, when sections of the template do not match. */
bool template_fill(char **out, size_t *size, const char *text, const json_t *data, struct err *err);

/* A JSON string of any bytes: those that are not UTF-8 are written as \xNN. */
json_t *template_text(const char *bytes);

#endif
