/* The canvas' WebGL 2. */
function graphics_context(canvas) {
	let why = "";
	canvas.addEventListener("webglcontextcreationerror", e => { why = e.statusMessage ? ` (${e.statusMessage})` : ""; });
	const gl = canvas.getContext("webgl2", { alpha: false, antialias: false, depth: false, powerPreference: "high-performance", preserveDrawingBuffer: true });
	if (!gl)
		throw new Error("this browser offers no WebGL 2" + why);
	return gl;
}

/* WebGL 2: programs, maps, targets. */
class Graphics {
	constructor(gl, shaders, constants) {
		this.exact = !!gl.getExtension("EXT_color_buffer_float");  // pictures of single precision, too
		if (!this.exact && !gl.getExtension("EXT_color_buffer_half_float"))
			throw new Error("this graphics driver cannot draw into floating-point pictures");
		this.gl = gl;
		this.shaders = shaders;
		this.constants = Object.entries(constants).map(([name, value]) => `#define ${name} ${value}\n`).join("");
		this.variants = {};
		this.counts = {};    // how often each kind of work was done
		this.compiled = [];  // in order: what a scene does not show is not compiled
		this.frame = gl.createFramebuffer();
		this.whole = gl.createVertexArray();
		gl.bindVertexArray(this.whole);
		const triangle = gl.createBuffer();
		gl.bindBuffer(gl.ARRAY_BUFFER, triangle);
		gl.bufferData(gl.ARRAY_BUFFER, new Float32Array([-1, -1, 3, -1, -1, 3]), gl.STATIC_DRAW);
		gl.enableVertexAttribArray(0);
		gl.vertexAttribPointer(0, 2, gl.FLOAT, false, 0, 0);
		const info = gl.getExtension("WEBGL_debug_renderer_info");
		this.name = String(gl.getParameter(info ? info.UNMASKED_RENDERER_WEBGL : gl.RENDERER));
		this.timer = gl.getExtension("EXT_disjoint_timer_query_webgl2");  // null: this browser tells no times of the graphics processor
		this.software = /swiftshader|llvmpipe|software|basic render/i.test(this.name);
	}

	counted(what) {
		this.counts[what] = (this.counts[what] || 0) + 1;
	}

	/* A program of the page's shaders; parts: others whose text, if they have any, goes before it, each
	 * defined by its name in capitals. The driver is
	 * not waited for before the program is used: it compiles while maps are decoded. */
	program(name, vertex, parts) {
		const gl = this.gl, program = gl.createProgram();
		const add = (type, text) => {
			const shader = gl.createShader(type);
			gl.shaderSource(shader, text);
			gl.compileShader(shader);
			gl.attachShader(program, shader);
			return shader;
		};
		const whole = "#version 300 es\nlayout(location=0) in vec2 at;\nvoid main() { gl_Position = vec4(at, 0.0, 1.0); }\n";
		add(gl.VERTEX_SHADER, vertex ? "#version 300 es\n" + this.shaders[vertex] : whole);
		const fragment = add(gl.FRAGMENT_SHADER, `#version 300 es\n${this.constants}${this.shaders.look}${this.shaders.common}${(parts || []).map(p => `#define ${p.toUpperCase()}\n`).join("")}${this.text(name, parts || [])}`);
		gl.linkProgram(program);
		this.compiled.push([name, ...(parts || [])].join("+"));
		return { name, program, fragment, uniforms: null };
	}

	/* One of two programs, with a part or without, compiled when it is first used: what a preset leaves out is not compiled. */
	variant(with_part, name, vertex, parts, part) {
		const key = [name, ...parts, with_part ? part : ""].join("+");
		this.variants[key] = this.variants[key] || this.program(name, vertex, with_part ? [...parts, part] : parts);
		return this.variants[key];
	}

	/* Its uniforms, once it is linked. */
	linked(p) {
		const gl = this.gl;
		if (!gl.getProgramParameter(p.program, gl.LINK_STATUS))
			throw new Error(`shader ${p.name}: ${gl.getShaderInfoLog(p.fragment)} ${gl.getProgramInfoLog(p.program)}`);
		p.uniforms = {};
		for (let i = 0; i < gl.getProgramParameter(p.program, gl.ACTIVE_UNIFORMS); i++) {
			const u = gl.getActiveUniform(p.program, i);
			p.uniforms[u.name.replace("[0]", "")] = { at: gl.getUniformLocation(p.program, u.name), type: u.type };
		}
		return p.uniforms;
	}

	/* The text of a shader with the parts that it uses before it. */
	text(name, parts) {
		const below = { eye: ["ground", "iris"], march: ["ground", "lights"], beside: ["ground", "lights"], horizon: ["ground"] }[name] || [];
		return [...below, ...parts.filter(p => p in this.shaders), name].map(p => this.shaders[p]).join("");
	}

	/* A pass of pose.glsl that draws nothing: its vertices are written into buffers (transform feedback). */
	feedback(part, outputs) {
		const gl = this.gl, program = gl.createProgram(), add = (type, text) => {
			const shader = gl.createShader(type);
			gl.shaderSource(shader, "#version 300 es\n" + text);
			gl.compileShader(shader);
			gl.attachShader(program, shader);
			return shader;
		};
		const shader = add(gl.VERTEX_SHADER, `${this.constants}#define ${part}\n${this.shaders.pose}`);
		add(gl.FRAGMENT_SHADER, "void main() {}\n");
		gl.transformFeedbackVaryings(program, outputs, gl.SEPARATE_ATTRIBS);
		gl.linkProgram(program);
		this.compiled.push(part.toLowerCase());
		return { name: part, program, fragment: shader, uniforms: null };
	}

	/* Runs such a pass over vertices of a shape; buffers: [buffer, first byte] of each output. */
	feed(p, values, shape, first, count, buffers) {
		const gl = this.gl;
		this.set(p, values);
		gl.bindVertexArray(shape);
		gl.enable(gl.RASTERIZER_DISCARD);
		buffers.forEach(([buffer, from], k) => gl.bindBufferRange(gl.TRANSFORM_FEEDBACK_BUFFER, k, buffer, from, 16 * count));
		gl.beginTransformFeedback(gl.POINTS);
		gl.drawArrays(gl.POINTS, first, count);
		gl.endTransformFeedback();
		buffers.forEach((_, k) => gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, k, null));
		gl.disable(gl.RASTERIZER_DISCARD);
		gl.bindVertexArray(null);
	}

	/* Makes a program the current one, with these uniforms; one that is a texture takes the next unit. */
	set(p, values) {
		const gl = this.gl;
		let unit = 0;
		gl.useProgram(p.program);
		for (const [name, u] of Object.entries(p.uniforms || this.linked(p))) {
			const v = values[name];
			if (v === undefined)
				throw new Error(`uniform ${name} is not set`);
			switch (u.type) {
			case gl.FLOAT: Array.isArray(v) ? gl.uniform1fv(u.at, v) : gl.uniform1f(u.at, v); break;
			case gl.FLOAT_VEC2: gl.uniform2fv(u.at, v); break;
			case gl.FLOAT_VEC3: gl.uniform3fv(u.at, v); break;
			case gl.FLOAT_VEC4: gl.uniform4fv(u.at, v); break;
			case gl.FLOAT_MAT3: gl.uniformMatrix3fv(u.at, true, v); break;
			case gl.FLOAT_MAT4: gl.uniformMatrix4fv(u.at, true, v); break;
			case gl.INT: case gl.BOOL: Array.isArray(v) ? gl.uniform1iv(u.at, v) : gl.uniform1i(u.at, v); break;
			case gl.SAMPLER_2D:
				gl.activeTexture(gl.TEXTURE0 + unit);
				gl.bindTexture(gl.TEXTURE_2D, v.texture);
				gl.uniform1i(u.at, unit++);
				break;
			default: throw new Error(`uniform ${name}: unknown type`);
			}
		}
	}

	/* Draws the whole target, or n_indices of a shape from the first on. */
	draw(p, values, shape, n_indices, first = 0) {
		const gl = this.gl;
		this.set(p, values);
		gl.bindVertexArray(shape || this.whole);
		if (shape)
			gl.drawElements(gl.TRIANGLES, n_indices, gl.UNSIGNED_INT, 4 * first);
		else
			gl.drawArrays(gl.TRIANGLES, 0, 3);
		gl.bindVertexArray(null);
	}

	texture(width, height, format, levels) {
		const gl = this.gl, texture = gl.createTexture();
		gl.bindTexture(gl.TEXTURE_2D, texture);
		gl.texStorage2D(gl.TEXTURE_2D, levels || 1, format, width, height);
		gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.LINEAR);
		gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, levels > 1 ? gl.LINEAR_MIPMAP_NEAREST : gl.LINEAR);
		gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
		gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
		return { texture, width, height };
	}

	/* A texture whose texels are read as they are; list: what is in it. */
	plain(width, height, format, kind, type, list) {
		const gl = this.gl, t = this.texture(width, height, format);
		gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, gl.NEAREST);
		gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, gl.NEAREST);
		if (list) {
			gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
			gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, width, height, kind, type, list);
		}
		return t;
	}

	/* Draws, and later tells how many ms the graphics processor took; never, where its clock was disturbed. One at a time. */
	timed(draw, told) {
		const { gl, timer } = this;
		if (!timer || this.timing) {
			draw();
			return;
		}
		const query = this.timing = gl.createQuery();
		gl.beginQuery(timer.TIME_ELAPSED_EXT, query);
		draw();
		gl.endQuery(timer.TIME_ELAPSED_EXT);
		const ask = () => {
			if (!gl.getQueryParameter(query, gl.QUERY_RESULT_AVAILABLE) && !gl.isContextLost()) {
				setTimeout(ask, 2);
				return;
			}
			const ms = gl.getQueryParameter(query, gl.QUERY_RESULT) / 1e6;
			gl.deleteQuery(query);
			this.timing = null;
			if (!gl.getParameter(timer.GPU_DISJOINT_EXT))
				told(ms);
		};
		setTimeout(ask, 0);
	}

	/* A texture of light: rgba, n x n. */
	light({ n, out }) {
		const gl = this.gl, t = this.texture(n, n, gl.RGBA16F);
		gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, n, n, gl.RGBA, gl.FLOAT, out);
		return t;
	}

	/* Draws into a texture (and another of its size, also), or (null) onto the page. */
	target(t, width, height, depth) {
		const gl = this.gl;
		gl.bindFramebuffer(gl.FRAMEBUFFER, t ? this.frame : null);
		if (t) {
			gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, t.texture, 0);
			gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT1, gl.TEXTURE_2D, t.also ? t.also.texture : null, 0);
			gl.drawBuffers(t.also ? [gl.COLOR_ATTACHMENT0, gl.COLOR_ATTACHMENT1] : [gl.COLOR_ATTACHMENT0]);
			gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth || null);
		}
		gl.viewport(0, 0, t ? t.width : width, t ? t.height : height);
	}

	static bytes(base64) {
		const text = atob(base64), out = new Uint8Array(text.length);
		for (let i = 0; i < out.length; i++)
			out[i] = text.charCodeAt(i);
		return out;
	}

	/* Decodes lib/draw/web/packed.c: bytes deflated, those of an item apart, each as its difference from the one `back` bytes before it. */
	static async unpacked({ size, item, back, deflate }) {
		const apart = new Uint8Array(await new Response(new Blob([Graphics.bytes(deflate)]).stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer());
		const out = new Uint8Array(size);
		for (let k = 0, from = 0; k < item; k++)
			for (let i = k; i < size; i += item)
				out[i] = apart[from++] + (i < back ? 0 : out[i - back]);
		return out;
	}

	/* Decodes lib/draw/web/field.c: whole steps, each stored as its difference from what its neighbours on the left and above foretell. */
	static field(m, width, height, channels) {
		const bytes = Graphics.bytes(m.bytes), row = width * channels, whole = new Int32Array(2 * row), out = new Float32Array(row * height);
		for (let y = 0, at = 0; y < height; y++)
			for (let i = 0, now = y % 2 * row, above = row - now; i < row; i++, now++, above++) {
				let v = 0, byte = 128;
				for (let shift = 0; byte > 127; shift += 7) {
					byte = bytes[at++];
					v |= (byte & 127) << shift;
				}
				whole[now] = (v >>> 1 ^ -(v & 1)) + whole[above] + (i < channels ? 0 : whole[now - channels] - whole[above - channels]);
				out[y * row + i] = whole[now] * m.step;
			}
		return out;
	}

	async bitmap(base64, type) {
		return createImageBitmap(new Blob([Graphics.bytes(base64)], { type }), { premultiplyAlpha: "none", colorSpaceConversion: "none" });
	}

	/* A map of the page's data as a texture; rows stay in order: row 0 is at 0. srgb: colours; else decoded to half floats. */
	async map(m, kind) {
		const gl = this.gl, bitmap = await this.bitmap(m.jpeg || m.png, m.jpeg ? "image/jpeg" : "image/png"), srgb = kind === "srgb";
		const levels = kind === "srgb" || kind === 0 ? 1 + Math.floor(Math.log2(m.width)) : 1;
		const raw = this.texture(m.width, m.height, srgb ? gl.SRGB8_ALPHA8 : gl.RGBA8, srgb ? levels : 1);
		gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
		gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
		gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, gl.RGBA, gl.UNSIGNED_BYTE, bitmap);
		bitmap.close();
		if (srgb) {
			gl.generateMipmap(gl.TEXTURE_2D);
			return raw;
		}
		this.decoder = this.decoder || this.program("decode");
		const out = this.texture(m.width, m.height, gl.RGBA16F, levels);
		this.target(out);
		this.draw(this.decoder, { map: raw, kind: kind === 0 ? 0 : kind === "plain" ? 2 : 1, low: [...m.low, 0], high: [...m.high, 1] });
		gl.deleteTexture(raw.texture);
		if (levels > 1) {
			gl.bindTexture(gl.TEXTURE_2D, out.texture);
			gl.generateMipmap(gl.TEXTURE_2D);
		}
		return out;
	}
}
