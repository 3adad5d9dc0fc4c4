"use strict";
/* What would run where text is taken for markup, for a script's text, or for a template. */
const HOSTILE = "</script><script>window.ran=1</script><img src=x onerror=window.ran=2>\"onload=window.ran=3 x='`${window.ran=4}`\u2028window.ran=5//\u2029-->{{&css}}&lt;";
module.exports = { HOSTILE };
