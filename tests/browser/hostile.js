"use strict";
/* Both pages of a folder whose every text is hostile: node hostile.js DIR... Nothing of it runs, and it is shown as what it is. */
const path = require("path");
const { pathToFileURL } = require("url");
const { Browser } = require("./browser.js");
const { HOSTILE } = require("./hostile_text.js");

const say = (ok, name, why) => console.log(ok ? `pass ${name}` : `fail ${name}: ${why}`);

(async () => {
	const b = await Browser.start();
	try {
		for (const dir of process.argv.slice(2))
			for (const page of ["index", "viewer"]) {
				const name = `hostile text, ${path.basename(dir).replace(/\W+/g, " ").trim()}, ${page}.html`;
				await b.open("about:blank");
				await b.open(pathToFileURL(path.join(dir, "work/review", `${page}.html`)).href);
				await b.until(`document.readyState === "complete" && (${page === "index"} || document.documentElement.dataset.open || !document.getElementById("stills").hidden)`, 60);
				const got = JSON.parse(await b.value(`JSON.stringify({ ran: window.ran, live: document.querySelectorAll("img[src=x], [onerror], [onload]").length,
					scripts: [...document.scripts].filter(s => !s.type || s.type === "module").length,
					shown: [...document.querySelectorAll("body *")].some(e => [...e.childNodes].some(n => n.nodeType === 3 && n.parentNode.tagName !== "SCRIPT" && (n.data.includes(${JSON.stringify(HOSTILE.slice(0, 40))}) || n.data.includes("<b>")))),
					stills: ${page === "viewer"} && !document.getElementById("stills").hidden && document.getElementById("why").textContent })`));
				say(got.ran === undefined && !got.live && got.scripts === 1, `${name}: nothing of it runs`, JSON.stringify(got));
				say(got.shown && !got.stills, `${name}: it is shown as text`, JSON.stringify(got));
			}
		say(!b.problems.length, "hostile text: no error on the console", b.problems.join("; "));
	} finally {
		await b.end();
	}
})().catch(e => { say(false, "hostile text in a browser", e.message); process.exit(1); });
