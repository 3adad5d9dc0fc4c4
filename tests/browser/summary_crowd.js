"use strict";
/* A folder of COUNT captures that have run, each with the work/ of a few: node summary_crowd.js CROWD COUNT WORK BARE
 * Every hundredth, and the first fifty, have WORK; the others BARE, the same without pictures. Some names are hostile, some are no UTF-8. Prints the names, a zero byte behind each. */
const fs = require("fs");
const [, , crowd, count, work, bare] = process.argv;
const at = (...parts) => Buffer.concat(parts.map(p => Buffer.from(p)));
for (let i = 0; i < +count; i++) {
	const name = i % 50 === 7 ? at(`n${i} "'><img src=x onerror=alert(1)> \n&amp;%2e`, [0xff])
		: i % 50 === 8 ? at(`javascript:alert(${i})%2e%2e#?\\`) : at(`capture ${String(i).padStart(6, "0")}`);
	fs.mkdirSync(at(crowd, "/", name));
	fs.symlinkSync(i < 50 || i % 100 === 8 ? work : bare, at(crowd, "/", name, "/work"));
	fs.writeFileSync(at(crowd, "/batch/results/", name), i % 20 === 7 ? `x\tfailed\t0.2\t\tlimbus: <b>alert(1)</b></script><script>window.ran=1</script> reason ${i}\n` : `x\tdone\t${i / 100}\t50\t\n`);
	process.stdout.write(at(name, [0]));
}
