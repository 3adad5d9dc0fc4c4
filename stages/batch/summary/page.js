"use strict";
/* Items: [state, name, folder, hash, thumb, review, seconds, reasons, numbers], worst first. Names and reasons are strangers' text: they
 * are set as text alone. Rows are made as they are scrolled to. */
const items = JSON.parse(document.getElementById("data").textContent);
const STATES = [["failed", "failed"], ["doubt", "doubtful"], ["runs", "running"], ["waits", "waiting"], ["pass", "passed"]];
const ORDERS = [["worst first", null], ["name", i => i[1]], ["chance to be wrong", i => i[8][0]], ["tilt's uncertainty", i => i[8][2]],
	["difference from the photograph", i => i[8][3]], ["share by the model, least first", i => i[8][4] === null ? null : -i[8][4]],
	["difference of the model alone", i => i[8][10]], ["border melanin", i => i[8][5]], ["stroma melanin", i => i[8][7]], ["time", i => i[6]]];
const PAGE = 60;
const list = document.getElementById("list"), end = document.getElementById("end"), find = document.getElementById("find"), order = document.getElementById("order");
const shown = new Set(STATES.map(s => s[0]));
const word = Object.fromEntries(STATES);
let chosen = [], next = 0;

function element(tag, of, text) {
	const e = document.createElement(tag);
	if (of)
		e.className = of;
	if (text !== undefined)
		e.textContent = text;
	return e;
}

function number(text, sigma) {
	const cell = element("td");
	if (text !== null) {
		cell.append(text);
		if (sigma)
			cell.append(element("span", "sigma", " ± " + sigma));
	}
	return cell;
}

const percent = x => x === null ? null : (100 * x).toPrecision(2) * 1 + " %";

function row(item) {
	const [state, name, folder, hash, thumb, review, seconds, reasons, n] = item, tr = element("tr"), picture = element("td"), what = element("td");
	if (thumb) {
		const img = element("img");
		img.loading = "lazy";
		img.alt = "";
		img.src = "thumbs/" + hash + ".jpg";
		picture.append(img);
	} else
		picture.append(element("span", "none"));
	const title = element(review ? "a" : "span", "name", name);
	if (review)
		title.href = "../" + folder + "/work/review/index.html";
	what.append(title, element("span", "state " + state, word[state]));
	for (const reason of reasons)
		what.append(element("p", "why", reason));
	tr.append(picture, what, number(percent(n[0])), number(n[1] === null ? null : n[1].toFixed(1) + "°", n[2] === null ? "" : n[2].toFixed(1) + "°"),
		number(n[3] === null ? null : n[3].toFixed(1)), number(n[10] === null ? null : n[10].toFixed(1)), number(percent(n[4])), number(percent(n[5]), percent(n[6])), number(percent(n[7]), percent(n[8])),
		number(n[9] === null ? null : n[9].toFixed(1) + " px"), number(seconds === null ? null : seconds.toFixed(1) + " s"));
	return tr;
}

function more() {
	const rows = document.createDocumentFragment();
	for (const to = Math.min(next + PAGE, chosen.length); next < to; next++)
		rows.append(row(chosen[next]));
	list.append(rows);
	end.textContent = chosen.length === 0 ? "None is like that." : `${next} of ${chosen.length} shown.`;
}

function choose() {
	const text = find.value.toLowerCase(), by = ORDERS[order.value][1];
	chosen = items.filter(i => shown.has(i[0]) && (!text || i[1].toLowerCase().includes(text) || i[7].some(r => r.toLowerCase().includes(text))));
	if (by) {
		const keyed = chosen.map(i => [by(i), i]);
		keyed.sort(([a], [b]) => a === null ? (b === null ? 0 : 1) : b === null ? -1 : typeof a === "string" ? (a < b ? -1 : a > b ? 1 : 0) : b - a);
		chosen = keyed.map(k => k[1]);
	}
	list.replaceChildren();
	next = 0;
	more();
}

const count = {};
for (const item of items)
	count[item[0]] = (count[item[0]] || 0) + 1;
document.getElementById("counts").textContent = `${items.length} captures: ` + STATES.filter(s => count[s[0]]).map(s => `${count[s[0]]} ${s[1]}`).join(", ");
for (const [state, name] of STATES) {
	if (!count[state])
		continue;
	const label = element("label"), box = element("input");
	box.type = "checkbox";
	box.checked = true;
	box.addEventListener("change", () => { box.checked ? shown.add(state) : shown.delete(state); choose(); });
	label.append(box, element("span", state, `${name} (${count[state]})`));
	document.getElementById("states").append(label);
}
ORDERS.forEach(([name], i) => { const o = element("option", "", name); o.value = i; order.append(o); });
document.getElementById("choose").addEventListener("submit", e => e.preventDefault());
find.addEventListener("input", choose);
order.addEventListener("change", choose);
new IntersectionObserver(seen => { if (seen.some(s => s.isIntersecting) && next < chosen.length) more(); }, { rootMargin: "1500px" }).observe(end);
choose();
