"use strict";
/* Hostile text wherever a capture folder's records hold text of their own: node spoil.js DIR. What programs compare (names of stages, of
 * inputs, statuses, methods) stays; figures get hostile names; the character's expressions, too. */
const fs = require("fs");
const path = require("path");
const { HOSTILE } = require("./hostile_text.js");

const [, , dir] = process.argv;
const free = /^(reason|note|why|unit|error|warning|setting|skipped|label|title|text|message)$/;

/* Of expressions: what drives beyond both eyes' ten. */
const model = path.join(dir, "work/skin/model.json"), expressions = fs.existsSync(model) ? JSON.parse(fs.readFileSync(model, "utf8")).inputs.slice(10).map(i => i.name) : [];

function spoilt(v, key) {
	if (typeof v === "string")
		return free.test(key) ? HOSTILE : expressions.includes(v) ? HOSTILE + v : v;
	if (Array.isArray(v))
		return v.map(x => spoilt(x, key));
	if (!v || typeof v !== "object")
		return v;
	return Object.fromEntries(Object.entries(v).map(([k, x], i) => [key === "figures" ? `${i} ${HOSTILE}` : k, k === "made_by" ? x : spoilt(x, k)]));
}

for (const at of fs.readdirSync(path.join(dir, "work"), { recursive: true })) {
	const file = path.join(dir, "work", at);
	if (!file.endsWith(".json") || at.startsWith(".made"))
		continue;
	const json = spoilt(JSON.parse(fs.readFileSync(file, "utf8")), "");
	if (at.startsWith("log"))
		Object.assign(json, { error: HOSTILE, skipped: [HOSTILE] });
	fs.writeFileSync(file, JSON.stringify(json));
}
// Values that no stage would take: the page reads animate's own.
const conf = path.join(dir, "capture.conf"), pieces = HOSTILE.match(/.{1,60}/g);
fs.appendFileSync(conf, ["animate.saccade_latency_s", "animate.blink_hz", "animate.pursuit_gain"].map((k, i) => `\n${k} = ${pieces[i]}`).join("") + "\n");
