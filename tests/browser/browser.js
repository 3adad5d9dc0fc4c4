"use strict";
/* A headless Chromium on a pipe: no port, no library. */
const { spawn } = require("child_process");
const fs = require("fs");
const os = require("os");
const path = require("path");

/* What draws: software, unless EYEWRIGHT_BROWSER_GL names one of ANGLE's ways to a graphics processor: vulkan, gl-egl, gl. */
const GL = process.env.EYEWRIGHT_BROWSER_GL || "swiftshader";
const GL_FLAGS = { swiftshader: ["--enable-unsafe-swiftshader"], vulkan: ["--enable-features=Vulkan", "--disable-vulkan-surface", "--ignore-gpu-blocklist"] };

class Browser {
	static async start(extra) {
		const b = new Browser();
		b.profile = fs.mkdtempSync(path.join(os.tmpdir(), "eyewright-browser-"));
		b.process = spawn("chromium", ["--headless=new", "--no-sandbox", "--disable-gpu-sandbox", "--use-gl=angle", `--use-angle=${GL}`,
			...(GL_FLAGS[GL] || ["--ignore-gpu-blocklist"]), "--remote-debugging-pipe", "--hide-scrollbars", "--mute-audio", "--no-first-run",
			"--disable-background-networking", "--host-resolver-rules=MAP * ~NOTFOUND", `--user-data-dir=${b.profile}`, ...(extra || []), "about:blank"],
			{ stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"], detached: true });
		Object.assign(b, { next: 1, waiting: new Map(), problems: [], requests: [], text: "" });
		b.process.stdio[4].on("data", data => b.receive(data));
		b.process.on("exit", () => b.waiting.forEach(w => w.reject(new Error("the browser ended"))));
		const { targetInfos } = await b.send("Target.getTargets");
		const page = targetInfos.find(t => t.type === "page");
		b.session = (await b.send("Target.attachToTarget", { targetId: page.targetId, flatten: true })).sessionId;
		for (const domain of ["Page", "Runtime", "Log", "Network"])
			await b.send(`${domain}.enable`);
		return b;
	}

	send(method, params, timeout) {
		const id = this.next++, message = { id, method, params: params || {} };
		if (this.session)
			message.sessionId = this.session;
		this.process.stdio[3].write(JSON.stringify(message) + "\0");
		return new Promise((resolve, reject) => {
			const timer = setTimeout(() => reject(new Error(`${method}: no answer`)), timeout || 60000);
			this.waiting.set(id, { resolve: v => { clearTimeout(timer); resolve(v); }, reject: e => { clearTimeout(timer); reject(e); } });
		});
	}

	receive(data) {
		this.text += data;
		for (let end; (end = this.text.indexOf("\0")) >= 0; this.text = this.text.slice(end + 1)) {
			const m = JSON.parse(this.text.slice(0, end));
			if (m.id) {
				const w = this.waiting.get(m.id);
				this.waiting.delete(m.id);
				if (w)
					m.error ? w.reject(new Error(m.error.message)) : w.resolve(m.result);
			} else if (m.method === "Runtime.exceptionThrown") {
				this.problems.push(m.params.exceptionDetails.exception?.description || m.params.exceptionDetails.text);
			} else if (m.method === "Runtime.consoleAPICalled" && ["error", "warning", "assert"].includes(m.params.type)) {
				this.problems.push(m.params.args.map(a => a.value ?? a.description).join(" "));
			} else if (m.method === "Log.entryAdded" && ["error", "warning"].includes(m.params.entry.level)) {
				this.problems.push(m.params.entry.text);
			} else if (m.method === "Network.requestWillBeSent") {
				this.requests.push(m.params.request.url.slice(0, 200));
			}
		}
	}

	async size(width, height, mobile) {
		await this.send("Emulation.setDeviceMetricsOverride", { width, height, deviceScaleFactor: 1, mobile: !!mobile });
	}

	async open(url) {
		await this.send("Page.navigate", { url });
	}

	/* The value of an expression on the page; promises are waited for. */
	async value(expression, timeout) {
		const r = await this.send("Runtime.evaluate", { expression, awaitPromise: true, returnByValue: true }, timeout);
		if (r.exceptionDetails)
			throw new Error(r.exceptionDetails.exception?.description || r.exceptionDetails.text);
		return r.result.value;
	}

	async until(expression, seconds) {
		for (const end = Date.now() + 1000 * seconds; Date.now() < end;) {
			if (await this.value(`!!(${expression})`))
				return;
			await new Promise(r => setTimeout(r, 50));
		}
		throw new Error(`after ${seconds} s still not: ${expression}`);
	}

	async screenshot(file) {
		const { data } = await this.send("Page.captureScreenshot", { format: "png" });
		fs.writeFileSync(file, Buffer.from(data, "base64"));
	}

	/* down: the left button is held. */
	async mouse(type, x, y, down) {
		const press = type !== "mouseMoved";
		await this.send("Input.dispatchMouseEvent", { type, x, y, button: press || down ? "left" : "none", buttons: down ? 1 : 0, clickCount: press ? 1 : 0 });
	}

	async key(key, code) {
		for (const type of ["keyDown", "keyUp"])
			await this.send("Input.dispatchKeyEvent", { type, key, code: code || key, windowsVirtualKeyCode: { ArrowLeft: 37, ArrowUp: 38, ArrowRight: 39, ArrowDown: 40, Escape: 27, Enter: 13 }[key] || 0, ...(key === "Enter" && type === "keyDown" ? { text: "\r" } : {}) });
	}

	async end() {
		const gone = new Promise(r => this.process.on("exit", r));
		process.kill(-this.process.pid, "SIGKILL");  // its helpers too
		await gone;
		for (let tries = 0; tries < 50; tries++)
			try {
				fs.rmSync(this.profile, { recursive: true, force: true });
				return;
			} catch (e) {
				await new Promise(r => setTimeout(r, 100));  // one of them has not noticed yet
			}
	}
}
module.exports = { Browser };
