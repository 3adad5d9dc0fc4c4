/* How eyes move: lib/motion/saccade.c, blink.c and motion/gaze_sim.c, live. Numbers are config/animate.conf's. Degrees, seconds. */
const motion = (() => {
	const random = () => {
		let u = 0;
		while (!u)
			u = Math.random();
		return Math.sqrt(-2 * Math.log(u)) * Math.cos(2 * Math.PI * Math.random());
	};
	const drawn = normal => Math.max(0.3 * normal[0], normal[0] + normal[1] * random());

	/* "key = value" lines; what the folder says goes before the defaults, where it is of their kind. */
	function configuration(data) {
		const conf = {};
		for (const line of data.defaults.split("\n")) {
			const m = /^([a-z_]+)\s*=\s*(.*)$/.exec(line);
			if (m)
				conf[m[1]] = m[2];
		}
		const numbers = text => {
			const v = text.trim().split(/\s+/).map(Number);
			return v.some(Number.isNaN) ? text : v.length > 1 ? v : v[0];
		};
		for (const key of Object.keys(conf)) {
			conf[key] = numbers(conf[key]);
			const own = key in data.own ? numbers(data.own[key]) : undefined;
			if (typeof own === typeof conf[key] && own.length === conf[key].length)
				conf[key] = own;
		}
		return conf;
	}

	function minimum_jerk(t) {
		t = Math.min(1, Math.max(0, t));
		return t * t * t * (10 + t * (6 * t - 15));
	}

	/* ln Gamma, Lanczos. */
	function lgamma(x) {
		const g = [76.18009172947146, -86.50532032941677, 24.01409824083091, -1.231739572450155, 0.1208650973866179e-2, -0.5395239384953e-5];
		let sum = 1.000000000190015;
		g.forEach((v, i) => { sum += v / (x + i + 1); });
		return -(x + 5.5) + (x + 0.5) * Math.log(x + 5.5) + Math.log(2.5066282746310005 * sum / x);
	}

	function peak_over_mean(n, m) {
		const a = n * m, b = n * (1 - m);
		return Math.exp(a * Math.log(m) + b * Math.log(1 - m) - (lgamma(a + 1) + lgamma(b + 1) - lgamma(n + 2)));
	}

	/* Velocity t^a (1 - t)^b, with the peak over the mean and the skew that the main sequence has. */
	function saccade(amplitude, conf) {
		const duration = (conf.saccade_duration_ms + conf.saccade_duration_ms_per_deg * amplitude) / 1000, SIZE = 128;
		const along = Math.min(1, Math.max(0, (amplitude - 1) / 39)), m = conf.saccade_skew[0] + (conf.saccade_skew[1] - conf.saccade_skew[0]) * along;
		let low = 0, high = 64;
		for (let i = 0; i < 60; i++) {
			const n = (low + high) / 2;
			if (peak_over_mean(n, m) < conf.saccade_peak_ratio)
				low = n;
			else
				high = n;
		}
		const n = (low + high) / 2, course = [0];
		for (let i = 0; i < SIZE; i++) {
			let sum = course[i];
			for (let k = 0; k < 16; k++) {
				const t = (i + (k + 0.5) / 16) / SIZE;
				sum += Math.pow(t, n * m) * Math.pow(1 - t, n * (1 - m));
			}
			course.push(sum);
		}
		return { amplitude, duration, at: t => {
			const u = t / duration * SIZE;
			if (!(u > 0))
				return 0;
			const i = Math.floor(Math.min(u, SIZE));
			return i === SIZE ? 1 : (course[i] + (u - i) * (course[i + 1] - course[i])) / course[SIZE];
		} };
	}

	function blink(start, amplitude, conf) {
		const down = (conf.blink_down_ms + conf.blink_down_ms_per_deg * amplitude) / 1000, hold = conf.blink_hold_ms / 1000;
		const up = down * conf.blink_up_over_down, deepest = Math.min(amplitude / conf.blink_full_deg, 1);
		return { end: start + down + hold + up, closure: t => {
			t -= start;
			return t >= down + hold + up ? 0 : t <= down ? deepest * minimum_jerk(t / down) : deepest * (1 - minimum_jerk((t - down - hold) / up));
		} };
	}

	/* One pair of eyes. target: where they are to look, set by the page; step(t) moves them there. */
	class Eyes {
		constructor(conf) {
			Object.assign(this, { conf, target: [0, 0], eye: [0, 0], drift: [0, 0], pursuit: [0, 0], last: [0, 0], time: null,
				slip: [], now: null, pending: null, rest: 0, lids: null, next: null, blinking: true, still: false, saccades: 0, closure: 0, winks: [null, null], winking: [0, 0] });
		}

		blink_now(t, amplitude) {
			this.lids = this.lids && this.lids.end > t ? this.lids : blink(t, amplitude || this.conf.blink_deg[0], this.conf);
		}

		/* One eye's lids, held shut for a moment: nobody winks as fast as he blinks. */
		wink_now(t, side) {
			this.winks[side] = blink(t, this.conf.blink_full_deg, { ...this.conf, blink_hold_ms: 200 });
		}

		/* True while a lid is moving. */
		lids_move(t) {
			return [this.lids, ...this.winks].some(l => l && l.end > t);
		}

		blinks(t) {
			const c = this.conf;
			if (this.next === null || this.lids && this.lids.end > t) {
				let f = -1;
				for (let i = 0; i < 1000 && !(f >= c.blink_hz_range[0] && f <= c.blink_hz_range[1]); i++)
					f = c.blink_hz[0] + c.blink_hz[1] * random();
				this.next = t + 1 / Math.max(f, c.blink_hz_range[0]);
			}
			if (this.blinking && t >= this.next) {
				this.blink_now(t, Math.max(0, c.blink_deg[0] + c.blink_deg[1] * random()));
				this.next = null;
			}
			this.closure = this.lids ? this.lids.closure(t) : 0;
			this.winking = this.winks.map(w => w ? w.closure(t) : 0);
		}

		begin(error, delayed, t) {
			const c = this.conf, length = Math.hypot(...error);
			this.pending = null;
			if (length <= 0.5 * c.saccade_threshold_deg)
				return;
			const gain = c.saccade_gain[0] + c.saccade_gain[1] * random();
			const ahead = (c.saccade_duration_ms + c.saccade_duration_ms_per_deg * length) / 1000;
			const way = [0, 1].map(k => {
				const to = this.eye[k] + gain * (error[k] + (delayed[k] - this.pursuit[k]) * ahead);
				return Math.min(c.range_deg, Math.max(-c.range_deg, to)) - this.eye[k];
			});
			const amplitude = Math.hypot(...way);
			if (amplitude < 0.01)
				return;
			this.now = { begin: t, way, done: [0, 0], course: saccade(amplitude, c) };
			this.saccades++;
			if (this.blinking && c.gaze_blink_deg > 0 && amplitude > c.gaze_blink_deg)
				this.blink_now(t);
		}

		/* One millisecond. */
		tick(t, target) {
			const c = this.conf, dt = 1e-3, error = [0, 1].map(k => target[k] - this.eye[k]), length = Math.hypot(...error);
			const speed = [0, 1].map(k => (target[k] - this.last[k]) / dt), jump = Math.hypot(...speed) > 120;
			this.last = target;
			this.slip.push(jump ? [0, 0] : speed);
			const delay = Math.round(c.pursuit_delay_s / dt);
			const delayed = this.slip.length > delay ? this.slip[this.slip.length - 1 - delay] : [0, 0];
			if (this.slip.length > 1024)
				this.slip.splice(0, 512);
			if (!this.now && this.pending === null && t >= this.rest && length > c.saccade_threshold_deg) {
				const closing = -error.reduce((sum, e, k) => sum + e / length * (delayed[k] - this.pursuit[k]), 0);
				const crossing = closing > 0 ? length / closing : Infinity;
				if (!(crossing >= c.crossing_s[0] && crossing <= c.crossing_s[1]))
					this.pending = t + drawn(Math.hypot(...this.pursuit) > 1 ? c.catch_up_latency_s : c.saccade_latency_s);
			}
			if (this.pending !== null && t >= this.pending)
				this.begin(error, delayed, t);
			for (const k of [0, 1]) {
				const asked = Math.min(c.pursuit_limit_deg_s, Math.max(-c.pursuit_limit_deg_s, c.pursuit_gain * delayed[k]));
				this.pursuit[k] += dt / c.pursuit_tau_s * (asked - this.pursuit[k]);
				this.eye[k] += dt * this.pursuit[k];
				if (this.now) {
					const to = this.now.way[k] * this.now.course.at(t - this.now.begin);
					this.eye[k] += to - this.now.done[k];
					this.now.done[k] = to;
				}
				const a = dt / c.drift_tau_s;
				this.drift[k] += -a * this.drift[k] + c.drift_deg * Math.sqrt(2 * a) * random();
			}
			if (this.now && t - this.now.begin >= this.now.course.duration) {
				this.now = null;
				this.rest = t + 0.02;
			}
		}

		/* To time t; true where the eyes or the lids have moved. */
		step(t) {
			const before = [...this.eye, this.closure, ...this.winking];
			if (this.still) {
				this.eye = [...this.target];
				this.time = t;
				this.blinks(t);
			} else {
				// The target is taken to have moved steadily since the last picture; a pause does not count as motion.
				if (this.time === null || t - this.time > 0.25) {
					this.time = this.time === null ? t : t - 0.25;
					this.last = [...this.target];
				}
				const begin = this.time, from = this.last;
				for (; this.time < t; this.time += 1e-3)
					this.tick(this.time, from.map((v, k) => v + (this.target[k] - v) * (this.time + 1e-3 < t ? (this.time - begin) / (t - begin) : 1)));
				this.blinks(t);
			}
			return Math.hypot(this.eye[0] - before[0], this.eye[1] - before[1]) > 2e-3 || [this.closure, ...this.winking].some((c, k) => c !== before[2 + k]);
		}
	}
	return { configuration, saccade, blink, Eyes };
})();
