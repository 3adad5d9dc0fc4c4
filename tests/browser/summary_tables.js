"use strict";
/* summary.csv and summary.json against the files of one capture: node summary_tables.js BATCH CAPTURES NAME PHOTOGRAPH */
const fs = require("fs");
const [, , batch, captures, name, photo] = process.argv;
const say = (ok, what, why) => console.log(ok ? `pass ${what}` : `fail ${what}: ${why}`);
const read = file => JSON.parse(fs.readFileSync(file, "utf8"));

/* Rows of CSV as RFC 4180 has it. */
function rows(text) {
	const out = [[]];
	let cell = "", quoted = false;
	for (let i = 0; i < text.length; i++) {
		const c = text[i];
		if (quoted && c === "\"" && text[i + 1] === "\"")
			cell += text[++i];
		else if (c === "\"")
			quoted = !quoted;
		else if (!quoted && (c === "," || c === "\n")) {
			out[out.length - 1].push(cell);
			cell = "";
			if (c === "\n")
				out.push([]);
		} else
			cell += c;
	}
	out.pop();
	return out;
}

const [head, ...table] = rows(fs.readFileSync(`${batch}/summary.csv`, "utf8"));
say(table.every(r => r.length === head.length), "each row has a cell for each column", head.length);
const cell = (row, key) => row[head.indexOf(key)];
const states = [...new Set(table.map(r => cell(r, "state")))];
say(states.join() === "failed,doubt,pass", "failed, doubtful, passed, in this order", states.join());
const hostile = table.find(r => r[0].includes("alert(1)"));
say(hostile && cell(hostile, "state") === "doubt" && cell(hostile, "doubts").includes("rejected: is no photograph"), "a doubtful capture says why", hostile && hostile.slice(0, 9).join());
say(table.some(r => r[0] === "bad_key" && cell(r, "reason").includes("unknown key")), "a failed one, too", "");

/* Each number of the fits, found again. */
const limbus = read(`${captures}/${name}/work/limbus/${photo}.json`), pigment = read(`${captures}/${name}/work/iris/pigment.json`);
const of = (kind, who) => table.find(r => r[0] === name && r[1] === kind && r[2] === who);
const pairs = [];
for (const key of ["theta_deg", "theta_sigma_deg", "phi_deg", "gross_probability", "rms_px", "coverage"])
	pairs.push([of("photograph", photo), `limbus.${key}`, limbus[key]]);
for (const [key, value] of [...Object.entries(limbus.ellipse).map(([k, v]) => [`ellipse.${k}`, v]), ...Object.entries(limbus.ellipse_sigma).map(([k, v]) => [`ellipse_sigma.${k}`, v]),
	...limbus.cam_from_eye.map((v, i) => [`cam_from_eye.${i}`, v])])
	pairs.push([of("photograph", photo), `limbus.${key}`, value]);
for (const layer of ["abl", "stroma"])
	for (const [key, value] of Object.entries(pigment[layer]))
		for (const what of ["value", "sigma"])
			if (value[what] !== undefined)
				pairs.push([of("capture", ""), `pigment.${layer}.${key}.${what}`, value[what]]);
const wrong = pairs.filter(([row, key, value]) => !row || !(Math.abs(cell(row, key) - value) <= 1e-11 * Math.abs(value)));
say(pairs.length > 30 && wrong.length === 0, `${pairs.length} numbers of ${name} stand in the table`, wrong.map(w => w[1]).slice(0, 5).join());

const all = read(`${batch}/summary.json`).captures, it = all.find(c => c.capture === name);
say(all.length === new Set(table.map(r => r[0])).size, "summary.json has the same captures", all.length);
say(it.records.find(r => r.part === "limbus").numbers.theta_deg === limbus.theta_deg, "and the same numbers", "");
const page = fs.readFileSync(`${batch}/index.html`, "utf8");
say(page.match(/<script/g).length === 2 && !page.includes("<img src=x") && !page.includes("<b>alert"), "the page's bytes hold no stranger's markup", "");
