"use strict";
/* The limbus drawn by hand on the review page, in a headless Chromium: node drawn.js INDEX LINES PICTURE
 * INDEX: a review page with one photograph. The line that the page offers is written to LINES, a picture of it to PICTURE.
 * Prints "pass NAME" or "fail NAME: WHY" a line. */
const fs = require("fs");
const { pathToFileURL } = require("url");
const { Browser } = require("./browser.js");

const [, , page, lines, picture] = process.argv;
const say = (ok, name, why) => console.log(ok ? `pass ${name}` : `fail ${name}: ${why}`);
const numbers = text => text.replace(/.*= /, "").split(" ").map(Number);

(async () => {
	const b = await Browser.start();
	try {
		await b.size(1300, 1000);
		await b.open(pathToFileURL(page).href);
		await b.until("document.querySelector('details.hand .line')?.textContent", 30);
		await b.value("document.querySelector('details.hand').open = true");
		await b.until("!document.querySelector('svg.hand').hasAttribute('hidden')", 10);
		// Pictures above come as they scroll into view, and move what lies below.
		for (let i = 0, last = ""; i < 40; i++) {
			await b.value("document.querySelector('svg.hand').scrollIntoView({ block: 'center', behavior: 'instant' })");
			await new Promise(r => setTimeout(r, 150));
			const now = await b.value("JSON.stringify(document.querySelector('svg.hand').getBoundingClientRect())");
			if (now === last)
				break;
			last = now;
		}
		const line = () => b.value("document.querySelector('details.hand .line').textContent");
		const grip = async i => JSON.parse(await b.value(`JSON.stringify((r => [r.x + r.width / 2, r.y + r.height / 2])(document.querySelectorAll('.grip')[${i}].getBoundingClientRect()))`));
		const scale = await b.value("(s => s.viewBox.baseVal.width / s.getBoundingClientRect().width)(document.querySelector('svg.hand'))");
		const drag = async (i, dx, dy) => {
			const [x, y] = await grip(i);
			await b.mouse("mousePressed", x, y, true);
			await b.mouse("mouseMoved", x + dx / 2, y + dy / 2, true);
			await b.mouse("mouseMoved", x + dx, y + dy, true);
			await b.mouse("mouseReleased", x + dx, y + dy);
		};
		const before = numbers(await line());
		say(before.length === 5 && before.every(Number.isFinite) && before[2] >= before[3], "an ellipse stands on the photograph", await line());
		await drag(0, 20, -10);
		let now = numbers(await line());
		say(Math.abs(now[0] - before[0] - 20 * scale) < 2 * scale && Math.abs(now[1] - before[1] + 10 * scale) < 2 * scale, "its middle is dragged", now.join(" "));
		// Both axes to given lengths: the longer one is named first.
		const [mx, my] = await grip(0), [ax, ay] = await grip(1);
		await drag(1, mx + 100 - ax, my - ay);
		const [bx, by] = await grip(2);
		await drag(2, mx - bx, my + 60 - by);
		now = numbers(await line());
		say(Math.abs(now[2] - 100 * scale) < 2 * scale && Math.abs(now[3] - 60 * scale) < 2 * scale && Math.min(now[4], 180 - now[4]) < 2, "its axes are dragged", now.join(" "));
		const [cx, cy] = await grip(2);
		await drag(2, mx - cx, my + 140 - cy);
		now = numbers(await line());
		say(Math.abs(now[2] - 140 * scale) < 2 * scale && Math.abs(now[3] - 100 * scale) < 2 * scale && Math.abs(now[4] - 90) < 2, "the longer axis comes first", now.join(" "));
		await b.value("document.querySelectorAll('.grip')[0].focus()");
		const at = numbers(await line());
		await b.key("ArrowRight");
		now = numbers(await line());
		say(now[0] > at[0] && now[1] === at[1], "arrow keys move a grip", `${at.join(" ")} -> ${now.join(" ")}`);
		fs.writeFileSync(lines, (await line()) + "\n");
		if (picture)
			await b.screenshot(picture);
		console.log(b.problems.length ? `fail drawn: no error: ${b.problems.join("; ")}` : "pass drawn: no error");
	} finally {
		await b.end();
	}
})().catch(e => { console.log(`fail drawn: ${e.message}`); process.exit(1); });
