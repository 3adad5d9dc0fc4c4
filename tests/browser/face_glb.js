"use strict";
/* Opens a driven face's .glb in three.js in a headless Chromium: FILE NPM OUT. One line a pose and view: what it shows of eye and skin, in
 * pixels round one eye; how deep lids go through the eye between open and shut, mm, by a blink's target alone and with what goes with it; and the same of eyes
 * that look down and up, with that look's target. OUT/face_NAME.png:
 * pictures; OUT is -: none is kept, and the first pose alone is drawn in the file's own materials, for what three.js says of them. FILE NPM OUT EXPRESSION...: the same from in front of open and shut eyes, and with the target of each of these in full alone, half and all the way down a blink, shut with half
 * of it, and shut and looking down; how far shut lids lie over each other, mm; and how deep they go through the eye on their way; nothing else. */
const fs = require("fs");
const os = require("os");
const path = require("path");
const { Browser } = require("./browser.js");
const [, , file, npm, out, ...expressions] = process.argv;

let poses = {
	open: [{}, [0, 0]],
	half: [{ eyeBlinkLeft: 0.5, eyeBlinkRight: 0.5, eyeBlinkLeft_half: 1, eyeBlinkRight_half: 1 }, [0, 0]],
	shut: [{ eyeBlinkLeft: 1, eyeBlinkRight: 1 }, [0, 0]],
	down: [{ eyeLookDownLeft: 1, eyeLookDownRight: 1 }, [0, -0.8]],
	up: [{ eyeLookUpLeft: 1, eyeLookUpRight: 1 }, [0, 0.8]],
	half_down: [{ eyeLookDownLeft: 1, eyeLookDownRight: 1, eyeBlinkLeft: 0.5, eyeBlinkRight: 0.5, eyeBlinkLeft_half: 1, eyeBlinkRight_half: 1, eyeBlinkLeft_down: 0.5, eyeBlinkRight_down: 0.5,
		eyeBlinkLeft_down_half: 1, eyeBlinkRight_down_half: 1 }, [0, -0.8]],
	shut_down: [{ eyeLookDownLeft: 1, eyeLookDownRight: 1, eyeBlinkLeft: 1, eyeBlinkRight: 1, eyeBlinkLeft_down: 1, eyeBlinkRight_down: 1 }, [0, -0.8]],
	left: [{ eyeLookOutLeft: 1, eyeLookInRight: 1 }, [1, 0]],
	right: [{ eyeLookInLeft: 1, eyeLookOutRight: 1 }, [-1, 0]],
};

/* Weights of a blink of both eyes by w, of an expression by v, with what goes with them. */
const both = (name, w) => ({ [name.replace("*", "Left")]: w, [name.replace("*", "Right")]: w });
const blinks = (w, e, v) => ({ [e]: v, ...both("eyeBlink*", w), ...both("eyeBlink*_half", 4 * w * (1 - w)), ...both(`eyeBlink*_${e}`, w * v), ...both(`eyeBlink*_${e}_half`, 4 * w * (1 - w) * v) });
if (expressions.length)
	poses = Object.fromEntries([["open", [{}, [0, 0]]], ["shut", poses.shut], ...expressions.flatMap(e => [[e, [{ [e]: 1 }, [0, 0]]], [`${e}_half`, [blinks(0.5, e, 1), [0, 0]]],
		[`${e}_shut`, [blinks(1, e, 1), [0, 0]]], [`${e}_little_shut`, [blinks(1, e, 0.5), [0, 0]]], [`${e}_shut_down`, [{ ...poses.shut_down[0], ...blinks(1, e, 1) }, [0, -0.8]]]])]);

(async () => {
	const dir = fs.mkdtempSync(path.join(os.tmpdir(), "eyewright-three-"));
	fs.writeFileSync(path.join(dir, "page.html"), fs.readFileSync(path.join(__dirname, "face_glb.html"), "utf8").replaceAll("NPM", `file://${path.resolve(npm)}/node_modules`));
	fs.copyFileSync(path.join(__dirname, "face_glb_page.js"), path.join(dir, "face_glb_page.js"));
	const b = await Browser.start(["--allow-file-access-from-files"]);
	try {
		await b.size(512, 512);
		await b.open(`file://${dir}/page.html`);
		await b.until("window.ready", 30);
		const says = await b.value(`open_face(${JSON.stringify(`file://${path.resolve(file)}`)})`, 120000);
		console.log(`meshes ${says.meshes.join(" ")}`);
		for (const [name, [weights, turn]] of Object.entries(poses))
			for (const side of ["left", "right"])
				for (const aside of expressions.length ? [0] : [-30, 0, 30]) {
					const n = await b.value(`seen(${JSON.stringify(weights)}, ${JSON.stringify(turn.map(t => 25 * t))}, "eye_${side}", ${aside})`, 120000);
					console.log(`${name} ${side} ${aside} eye ${n.eye} skin ${n.skin} behind ${n.behind} nothing ${n.nothing} hair ${n.hair} tears ${n.tears} islands ${n.islands} through ${n.through}`);
				}
		for (const side of expressions.length ? [] : ["left", "right"]) {
			const d = await b.value(`depths("${side}")`, 120000);
			console.log(`depth ${side} alone ${d.alone.map(x => x.toFixed(3)).join(" ")} both ${d.both.map(x => x.toFixed(3)).join(" ")} of ${d.n}`);
			for (const [name, look, v] of [["down", "eyeLookDown", -20], ["up", "eyeLookUp", 20]]) {
				const t = await b.value(`depths("${side}", "${look}${side === "left" ? "Left" : "Right"}", "${name}", ${v})`, 120000);
				console.log(`turned ${side} ${name} blink ${t.both.map(x => x.toFixed(3)).join(" ")} open ${t.open.toFixed(3)} of ${t.n}`);
			}
		}
		for (const side of expressions.length ? ["left", "right"] : []) {
			for (const name of Object.keys(poses).filter(n => n.endsWith("shut")))
				console.log(`over ${name} ${side} ${(await b.value(`over(${JSON.stringify(poses[name][0])}, "eye_${side}")`, 120000)).toFixed(3)}`);
			for (const e of expressions) {
				const t = await b.value(`depths("${side}", "${e}", "${e}")`, 120000);
				console.log(`along ${side} ${e} blink ${t.both.map(x => x.toFixed(3)).join(" ")} open ${t.open.toFixed(3)} of ${t.n}`);
			}
		}
		const kept = out !== "-";
		for (const [name, [weights, turn]] of Object.entries(poses).slice(0, kept ? undefined : 1))
			for (const [side, aside] of [["left", 0], ["right", 0], ["left", 70]].slice(0, expressions.length ? 2 : 3)) {
				await b.value(`show(${JSON.stringify(weights)}, ${JSON.stringify(turn.map(t => 25 * t))}, "eye_${side}", ${aside})`, 120000);
				await b.screenshot(path.join(kept ? out : dir, `face_${name}_${side}${aside || ""}.png`));
			}
		for (const problem of b.problems)
			if (!/GPU stall|ReadPixels/.test(problem))
				console.log(`fail three.js says: ${problem}`);
	} catch (e) {
		console.log(`fail three.js: ${e.message} ${b.problems.join("; ")}`);
	} finally {
		await b.end();
		fs.rmSync(dir, { recursive: true, force: true });
	}
})();
