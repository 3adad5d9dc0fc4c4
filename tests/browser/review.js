"use strict";
/* The review page in a headless Chromium: node review.js SHOTS ALONE TOLD PAGE... Its pictures open large, on a phone it fits and its
 * targets are large enough for a finger, its words are plain. ALONE: a folder for a copy of the first page without the files beside it;
 * TOLD: a page whose records hold what stages write at worst.
 * Prints "pass NAME" or "fail NAME: WHY" a line. */
const fs = require("fs");
const path = require("path");
const { pathToFileURL } = require("url");
const { Browser } = require("./browser.js");

const [, , shots, alone, told, ...pages] = process.argv;
const say = (ok, name, why) => console.log(ok ? `pass ${name}` : `fail ${name}: ${why}`);
const url = page => pathToFileURL(page).href;
const state = `JSON.stringify((d => d ? { open: d.open, whole: d.dataset.whole, alt: d.querySelector("img").alt, loaded: d.querySelector("img").naturalWidth, words: d.querySelector("p").textContent,
	sheet: d.querySelector(".sheet").getBoundingClientRect(), room: d.querySelector(".big").getBoundingClientRect(), drawn: !!d.querySelector(".sheet svg"), source: d.querySelector("img").src.slice(0, 5) } : {})(document.querySelector("dialog")))`;

async function open(b, page) {
	await b.open("about:blank");
	await b.until("location.href === 'about:blank'", 20);
	await b.open(url(page));
	await b.until("document.readyState === 'complete' && location.href !== 'about:blank'", 60);
	await b.value("document.documentElement.style.scrollBehavior = 'auto'; document.querySelectorAll('details').forEach(d => { d.open = true; }); document.querySelectorAll('img').forEach(i => { i.loading = 'eager'; })");
	await b.until("[...document.images].every(i => i.complete)", 60);
}

const now = async b => JSON.parse(await b.value(state));

/* Each picture opens as large as the window allows, its file in place of the page's own small one. */
async function large(b, page) {
	const name = path.basename(path.resolve(page, "../../.."));
	await open(b, page);
	const n = await b.value("document.querySelectorAll('a.large').length"), bare = await b.value("[...document.querySelectorAll('main img')].filter(i => !i.closest('a.large') && !i.closest('.slider')).length");
	say(n > 0 && bare === 0, `${name}: no picture that does not open`, `${n} open, ${bare} do not`);
	const sliders = await b.value("[...document.querySelectorAll('.likeness')].map(f => f.querySelectorAll('.open a.large').length).join()");
	say(!/[^2,]/.test(sliders), `${name}: both pictures of a comparison open`, sliders);
	const wrong = [];
	for (let i = 0; i < n; i++) {
		await b.value(`document.querySelectorAll('a.large')[${i}].click()`);
		const file = await b.value(`document.querySelectorAll('a.large')[${i}].hasAttribute("href")`);
		await b.until(file ? "document.querySelector('dialog').dataset.whole" : "document.querySelector('dialog img').complete", 20).catch(() => 0);
		const s = await now(b), fills = Math.max(s.sheet.width / s.room.width, s.sheet.height / s.room.height);
		if (!s.open || !(s.loaded > 0) || Math.abs(fills - 1) > 0.01 || file && (s.whole !== "1" || s.source !== "file:"))
			wrong.push([i, file, s.whole, fills.toFixed(3), s.source].join(" "));
		await b.value("document.querySelector('dialog').close()");
	}
	say(!wrong.length, `${name}: all ${n} fill the window, by their files`, wrong.slice(0, 3).join("; "));
	const html = fs.readFileSync(page, "utf8"), links = [...html.matchAll(/<a class="large"[^>]* href="([^"]*)"/g)].map(m => m[1]);
	const lost = links.filter(l => !fs.existsSync(path.join(path.dirname(page), decodeURIComponent(l))));
	say(links.length > 0 && !lost.length, `${name}: without the script the links lead to files`, `${links.length}: ${lost.slice(0, 3)}`);
}

async function by_keys(b) {
	await open(b, pages[0]);
	await b.value("document.querySelector('.gallery a.large').focus()");
	await b.key("Enter");
	const first = await now(b);
	await b.key("ArrowRight");
	const second = await now(b);
	await b.key("ArrowLeft");
	const third = await now(b);
	say(first.open && second.alt !== first.alt && third.alt === first.alt, "Enter opens, arrow keys go on and back", JSON.stringify([first.alt, second.alt, third.alt]));
	await b.key("+");
	const near = await now(b);
	await b.key("-");
	say(near.sheet.width > 1.9 * third.sheet.width && Math.abs((await now(b)).sheet.width - third.sheet.width) < 1, "plus and minus go nearer and back", `${near.sheet.width} ${third.sheet.width}`);
	await b.key("Escape");
	await b.until("!document.querySelector('dialog').open", 10).catch(() => 0);
	say(!(await now(b)).open && await b.value("document.activeElement === document.querySelector('.gallery a.large')"), "Escape closes it where it was opened", "");
	// Maps have no file of their own that a browser could show: buttons.
	await b.value("document.querySelector('#iris a.large').focus()");
	await b.key("Enter");
	say((await now(b)).open, "a map without a file opens by keys, too", "");
	await b.key("Escape");
	const box = JSON.parse(await b.value("(e => { e.scrollIntoView({ block: 'center' }); return JSON.stringify(e.getBoundingClientRect()); })(document.querySelector('.frame a.large'))"));
	for (const type of ["mousePressed", "mouseReleased"])
		await b.mouse(type, box.x + box.width / 4, box.y + box.height / 4);
	await b.until("document.querySelector('dialog').open && document.querySelector('dialog').dataset.whole", 10).catch(() => 0);
	const photo = await now(b);
	say(photo.open && photo.drawn, "a click on a photograph opens it, its ellipses drawn on it", JSON.stringify(photo));
	await b.screenshot(path.join(shots, "review_large.png"));
}

async function by_fingers(b) {
	await b.size(390, 844, true);
	await b.send("Emulation.setTouchEmulationEnabled", { enabled: true });
	await open(b, pages[0]);
	const touch = (type, x, y) => b.send("Input.dispatchTouchEvent", { type, touchPoints: type === "touchEnd" ? [] : [{ x, y }] });
	const tap = async (x, y) => { await touch("touchStart", x, y); await touch("touchEnd"); };
	const box = JSON.parse(await b.value("(e => { e.scrollIntoView({ block: 'center' }); return JSON.stringify(e.getBoundingClientRect()); })(document.querySelector('.gallery a.large'))"));
	await tap(box.x + box.width / 2, box.y + box.height / 2);
	await b.until("document.querySelector('dialog').open && document.querySelector('dialog').dataset.whole", 10).catch(() => 0);
	const first = await now(b), y = first.room.top + first.room.height / 2;
	await touch("touchStart", 300, y);
	for (const x of [260, 200, 140, 100, 100]) {  // it comes to rest: after a fling a browser takes no tap for a while
		await touch("touchMove", x, y);
		await new Promise(r => setTimeout(r, 60));
	}
	await touch("touchEnd");
	const second = await now(b);
	say(first.open && second.open && second.alt !== first.alt, "a tap opens, a finger drawn aside goes on", JSON.stringify([first.alt, second.alt]));
	await tap(195, second.room.top + second.room.height / 2);
	await b.until(`document.querySelector('.sheet').getBoundingClientRect().width > ${1.9 * second.sheet.width}`, 10).catch(() => 0);
	say((await now(b)).sheet.width > 1.9 * second.sheet.width, "a tap on it goes nearer", `${(await now(b)).sheet.width}`);
	const small = await b.value("[...document.querySelectorAll('dialog button')].map(e => e.getBoundingClientRect()).filter(r => r.width < 44 || r.height < 44).length");
	say(small === 0, "its buttons are large enough for a finger", small);
	await b.screenshot(path.join(shots, "review_large_phone.png"));
	await b.value("document.querySelector('dialog').close()");
}

/* 390 px wide, by touch: nothing runs over; what is tapped is 44 px or more each way. */
async function phone(b, page) {
	const name = path.basename(path.resolve(page, "../../.."));
	await open(b, page);
	const wide = JSON.parse(await b.value("JSON.stringify([document.documentElement.scrollWidth, ...[...document.querySelectorAll('.scroll')].map(s => s.scrollWidth - s.clientWidth)])"));
	say(wide[0] <= 390 && wide.slice(1).every(v => v <= 0) && wide.length > 1, `${name}: fits a phone, and so do its tables`, wide.join());
	const small = JSON.parse(await b.value(`JSON.stringify([...document.querySelectorAll("main a, nav a, header a, summary, button, input")].filter(e => e.checkVisibility() && !e.closest("dialog") && !e.matches(".skip")).map(e => [e.textContent.trim().slice(0, 20) || e.tagName, e.getBoundingClientRect(), e.matches("a.large")]).filter(([, r]) => r.width < 44 || r.height < 44).map(([t, r, picture]) => [t, Math.round(r.width), Math.round(r.height), picture]))`));
	// A picture that is a strip of the whole width is as high as it is.
	const bad = small.filter(([, w, h, picture]) => !(picture && w > 300 && h > 24));
	say(!bad.length, `${name}: its targets are 44 px or more`, JSON.stringify(bad));
	const hit = JSON.parse(await b.value(`JSON.stringify([...document.querySelectorAll("svg.hand:not([hidden]) .grip")].map(g => { g.scrollIntoView({ block: "center" }); const r = g.getBoundingClientRect(), x = r.left + r.width / 2, y = r.top + r.height / 2;
		return [[20, 0], [-20, 0], [0, 20], [0, -20]].every(([i, j]) => (e => e && e.closest(".grip"))(document.elementFromPoint(x + i, y + j))); }))`));
	say(hit.every(v => v), `${name}: so are the grips of the ellipse`, hit.join());
	await b.screenshot(path.join(shots, `review_phone_${name.replace(/\W/g, "")}.png`));
}

/* No exponents, no keys of files. */
async function plain(b, page, name) {
	await open(b, page);
	const text = await b.value("document.body.innerText"), bad = text.replace("photo_1e5 stays", "").match(/.{0,30}([0-9]e[+-]?[0-9]|held_by).{0,30}/g);
	say(text.length > 500 && !bad, `${name}: plain words for every number`, String(bad && bad.slice(0, 3)));
	return text;
}

(async () => {
	const b = await Browser.start();
	try {
		await b.size(1200, 900);
		for (const page of pages)
			await large(b, page);
		await by_keys(b);
		for (const page of pages)
			await plain(b, page, path.basename(path.resolve(page, "../../..")));
		const text = await plain(b, told, "records of stages at their worst");
		const wanted = [/456\u202f812 of 9/, /probability of 0\.000012, must be at most 0\.001\b/, /below 0\.000001 mm/, /12\u202f300\u202f000 px/, /photo_1e5 stays/, /-0\.00025 %/];
		say(wanted.every(w => w.test(text)), "their numbers are told as they are", wanted.filter(w => !w.test(text)).join());
		await by_fingers(b);
		for (const page of pages)
			await phone(b, page);
		say(!b.problems.length, "the review: no error on the console", b.problems.slice(0, 3).join("; "));
		const outside = b.requests.filter(r => !/^(file|data|about|chrome):/.test(r));
		say(!outside.length, "the review fetches nothing", outside.join());
		// The page by itself, sent to somebody: its own pictures stay.
		const copy = path.join(alone, "index.html");
		fs.copyFileSync(pages[0], copy);
		await open(b, copy);
		await b.value("document.querySelector('.gallery a.large').click()");
		await new Promise(r => setTimeout(r, 500));
		const s = await now(b);
		say(s.open && s.loaded > 0 && s.source === "data:" && s.whole === "", "without the files beside it the page's own pictures open", JSON.stringify(s));
	} finally {
		await b.end();
	}
})().catch(e => { say(false, "the review page in a browser", e.message); process.exit(1); });
