"use strict";
/* The page of many captures in a headless Chromium: node summary.js INDEX COUNT PICTURE
 * INDEX: batch/index.html; COUNT captures must be told of; PICTURE: the page's first screen.
 * Prints "pass NAME" or "fail NAME: WHY" a line. */
const fs = require("fs");
const { pathToFileURL } = require("url");
const { Browser } = require("./browser.js");

const [, , page, count, picture] = process.argv;
const say = (ok, name, why) => console.log(ok ? `pass ${name}` : `fail ${name}: ${why}`);

(async () => {
	const b = await Browser.start();
	try {
		await b.size(1300, 1000);
		const begin = Date.now();
		await b.open(pathToFileURL(page).href);
		await b.until("document.querySelectorAll('#list tr').length > 0 && document.querySelector('#list img')?.complete", 60);
		console.log(`  opened in ${(Date.now() - begin) / 1000} s`);
		say((await b.value("document.getElementById('counts').textContent")).startsWith(`${count} captures: `), "all are counted", await b.value("document.getElementById('counts').textContent"));
		say(await b.value("document.querySelector('#list .state').classList.contains('failed')"), "the worst stand first", "");
		say(await b.value("[...document.querySelectorAll('#list img')].some(i => i.naturalWidth > 30)"), "pictures are shown", "");
		await b.screenshot(picture);
		const hrefs = JSON.parse(await b.value("JSON.stringify(items.filter(i => i[5]).slice(0, 500).map(i => { const a = document.createElement('a'); a.href = '../' + i[2] + '/work/review/index.html'; return a.href; }))"));
		// Names of folders are bytes: not all are UTF-8.
		const bytes = h => Buffer.from(new URL(h).pathname.replace(/%([0-9a-f]{2})/gi, (_, x) => String.fromCharCode(parseInt(x, 16))), "latin1");
		const lost = hrefs.filter(h => !h.startsWith("file:") || !fs.existsSync(bytes(h)));
		say(hrefs.length > 0 && lost.length === 0, "links lead to the reviews", `${hrefs.length}: ${lost[0]}`);
		const before = await b.value("document.querySelectorAll('#list tr').length");
		await b.value("window.scrollTo(0, document.body.scrollHeight)");
		if (count > 100) {
			// How long a page takes to open hangs on the machine; that it draws a few rows of many, on the page alone.
			say(before < 500, "few rows are drawn at first", `${before} rows`);
			await b.until(`document.querySelectorAll("#list tr").length > ${before}`, 10);
			say(true, "more come when scrolled to");
		}
		await b.value("find.value = 'alert'; find.dispatchEvent(new Event('input')); window.scrollTo(0, 0)");
		say(await b.value("chosen.length > 0 && chosen.every(i => JSON.stringify(i).includes('alert'))"), "found by name", "");
		await b.value("find.value = ''; order.value = 2; order.dispatchEvent(new Event('change'))");
		say(await b.value("chosen.length === items.length && chosen.every((c, i) => !i || chosen[i - 1][8][0] === c[8][0] || chosen[i - 1][8][0] > c[8][0] || c[8][0] === null)"), "ordered by a number", "");
		say(await b.value("window.ran === undefined && document.querySelectorAll('#list img[onerror], #list script, #list b').length === 0"), "no name or reason is live", "");
		say(b.problems.length === 0, "no error", b.problems.slice(0, 3).join("; "));
		say(b.requests.every(r => r.startsWith("file:") || r.startsWith("data:")), "nothing is loaded from elsewhere", b.requests.filter(r => !r.startsWith("file:"))[0]);
	} catch (e) {
		say(false, "the page of many captures", e.stack.slice(0, 400));
	} finally {
		await b.end();
	}
})();
