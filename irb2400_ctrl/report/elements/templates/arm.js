// The arm that turns and plays: bodies lit by WebGL, the tool's way drawn over them.
"use strict";
(() => {
  const LOOKS = { base: [0.45, 0.47, 0.5], arm: [0.95, 0.46, 0.16], tool: [0.32, 0.36, 0.42], part: [0.62, 0.72, 0.8], thing: [0.6, 0.6, 0.56] };
  const RAMP = [[49, 54, 149], [69, 147, 206], [110, 190, 140], [250, 190, 70], [200, 40, 40]];
  const TURNS = { iso: [-0.9, 0.45], front: [0, 0.05], side: [-Math.PI / 2, 0.05], top: [0, 1.5] };
  const floats = (text) => new Float32Array(Uint8Array.from(atob(text), (c) => c.charCodeAt(0)).buffer);
  const colour = (t) => {
    const at = Math.min(Math.max(t, 0), 1) * (RAMP.length - 1), k = Math.min(Math.floor(at), RAMP.length - 2);
    return `rgb(${RAMP[k].map((v, i) => Math.round(v + (RAMP[k + 1][i] - v) * (at - k))).join()})`;
  };
  // matrices are columns of four, as WebGL takes them
  const times = (a, b) => {
    const c = new Float32Array(16);
    for (let j = 0; j < 4; j++) for (let i = 0; i < 4; i++) for (let k = 0; k < 4; k++) c[4 * j + i] += a[4 * k + i] * b[4 * j + k];
    return c;
  };
  const posed = (p) => {
    const [x, y, z, a, b, c, d] = p, n = 2 / (a * a + b * b + c * c + d * d);
    return new Float32Array([
      1 - n * (b * b + c * c), n * (a * b + c * d), n * (a * c - b * d), 0,
      n * (a * b - c * d), 1 - n * (a * a + c * c), n * (b * c + a * d), 0,
      n * (a * c + b * d), n * (b * c - a * d), 1 - n * (a * a + b * b), 0, x, y, z, 1]);
  };
  const turned = (m, v) => [0, 1, 2].map((i) => m[i] * v[0] + m[4 + i] * v[1] + m[8 + i] * v[2] + m[12 + i]);

  // a profile of [radius, height, normal outwards, normal up] turned about z: triangles with normals
  const lathe = (profile) => {
    const found = [], N = 28, at = (p, k) => {
      const a = (2 * Math.PI * k) / N, [r, z, o, u] = p;
      return [r * Math.cos(a), r * Math.sin(a), z, o * Math.cos(a), o * Math.sin(a), u];
    };
    for (let i = 0; i + 1 < profile.length; i++) for (let k = 0; k < N; k++) {
      const [a, b, c, d] = [at(profile[i], k), at(profile[i], k + 1), at(profile[i + 1], k), at(profile[i + 1], k + 1)];
      found.push(...a, ...b, ...c, ...b, ...d, ...c);
    }
    return new Float32Array(found);
  };
  const capsule = ({ radius: r, length: l }) => {
    const profile = [];
    for (const side of [1, -1]) for (let k = 0; k <= 8; k++) {
      const a = (Math.PI / 16) * (side > 0 ? k : 8 - k), o = Math.sin(a), u = side * Math.cos(a);
      profile.push([r * o, (side * l) / 2 + r * u, o, u]);
    }
    return lathe(profile);
  };
  const cylinder = ({ radius: r, length: l }) =>
    lathe([[0, l / 2, 0, 1], [r, l / 2, 0, 1], [r, l / 2, 1, 0], [r, -l / 2, 1, 0], [r, -l / 2, 0, -1], [0, -l / 2, 0, -1]]);
  const facets = (points) => {
    const found = [];
    for (let k = 0; k + 8 < points.length; k += 9) {
      const [a, b, c] = [0, 3, 6].map((o) => [...points.slice(k + o, k + o + 3)]);
      const u = b.map((v, i) => v - a[i]), w = c.map((v, i) => v - a[i]);
      let n = [u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]];
      const size = Math.hypot(...n) || 1;
      n = n.map((v) => v / size);
      found.push(...a, ...n, ...b, ...n, ...c, ...n);
    }
    return new Float32Array(found);
  };
  const box = ({ size }) => {
    const points = [];
    for (let axis = 0; axis < 3; axis++) for (const side of [1, -1]) {
      const corner = (u, v) => {
        const p = [0, 0, 0];
        p[axis] = (side * size[axis]) / 2;
        p[(axis + 1) % 3] = (u * size[(axis + 1) % 3]) / 2;
        p[(axis + 2) % 3] = (v * side * size[(axis + 2) % 3]) / 2;
        return p;
      };
      for (const [u, v] of [[-1, -1], [1, -1], [1, 1], [-1, -1], [1, 1], [-1, 1]]) points.push(...corner(u, v));
    }
    return facets(points);
  };
  const SHAPES = { capsule, cylinder, box, mesh: ({ corners }) => facets(floats(corners)) };

  const VERTEX = `attribute vec3 place; attribute vec3 normal; uniform mat4 look; uniform mat4 body; varying vec3 n;
    void main() { n = mat3(body) * normal; gl_Position = look * body * vec4(place, 1.0); }`;
  const FRAGMENT = `precision mediump float; varying vec3 n; uniform vec4 tint; uniform vec3 toward;
    void main() { vec3 m = normalize(n); if (dot(m, toward) < 0.0) m = -m;
      float lit = 0.5 + 0.32 * max(dot(m, normalize(vec3(0.4, -0.5, 0.9))), 0.0) + 0.2 * m.z;
      float rim = pow(1.0 - max(dot(m, toward), 0.0), 3.0);
      gl_FragColor = tint.a < 1.0 ? vec4(tint.rgb * tint.a, tint.a) : vec4(tint.rgb * lit * (1.0 - 0.45 * rim) + 0.04, 1.0); }`;

  class Arm {
    constructor(figure) {
      this.figure = figure;
      this.data = JSON.parse(figure.querySelector("script.data").textContent);
      this.frames = floats(this.data.frames);
      this.way = floats(this.data.way);
      this.reference = this.data.reference && floats(this.data.reference);
      this.count = this.way.length / 3;
      this.fields = this.data.fields.map((f) => ({ ...f, values: floats(f.values) }));
      this.field = this.fields[0] || null;
      this.time = this.data.start;
      this.playing = false;
      this.zoom = 1;
      [this.yaw, this.pitch] = TURNS.iso;
      this.fit();
      this.solid = figure.querySelector(".solid");
      this.lines = figure.querySelector(".lines");
      this.prepare();
      this.wire();
      new ResizeObserver(() => this.draw()).observe(this.solid);
      this.draw();
    }
    fit() {
      // a sphere around the arm at some poses and the tool's way
      const points = [], radii = [], step = 7 * this.data.links, some = Math.max(1, Math.floor(this.count / 30));
      const arm = this.data.bodies.filter((b) => LOOKS[b.look] !== LOOKS.thing && LOOKS[b.look] !== LOOKS.part);
      for (let frame = 0; frame < this.count; frame += some)
        for (const body of arm) {
          const at = frame * step + 7 * body.link, pose = times(posed(this.frames.slice(at, at + 7)), posed(body.place));
          for (const end of [-0.5, 0.5]) {
            points.push(turned(pose, [0, 0, end * (body.length || 0)]));
            radii.push(body.radius || 0.1);
          }
        }
      for (let k = 0; k < this.way.length; k += 3) {
        points.push([...this.way.slice(k, k + 3)]);
        radii.push(0);
      }
      const low = [0, 1, 2].map((i) => Math.min(...points.map((p, k) => p[i] - radii[k])));
      const high = [0, 1, 2].map((i) => Math.max(...points.map((p, k) => p[i] + radii[k])));
      this.centre = low.map((v, i) => (v + high[i]) / 2);
      this.radius = Math.hypot(...low.map((v, i) => high[i] - v)) / 2;
    }
    prepare() {
      const gl = (this.gl = this.solid.getContext("webgl", { antialias: true, preserveDrawingBuffer: true }));
      if (!gl) return;
      const program = gl.createProgram();
      for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, FRAGMENT]]) {
        const shader = gl.createShader(kind);
        gl.shaderSource(shader, source);
        gl.compileShader(shader);
        gl.attachShader(program, shader);
      }
      gl.linkProgram(program);
      gl.useProgram(program);
      this.slots = { place: gl.getAttribLocation(program, "place"), normal: gl.getAttribLocation(program, "normal") };
      for (const name of ["look", "body", "tint", "toward"]) this.slots[name] = gl.getUniformLocation(program, name);
      const buffered = (points) => {
        const buffer = gl.createBuffer();
        gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
        gl.bufferData(gl.ARRAY_BUFFER, points, gl.STATIC_DRAW);
        return [buffer, points.length / 6];
      };
      this.bodies = this.data.bodies.map((b) => ({ ...b, own: posed(b.place), buffer: buffered(SHAPES[b.kind](b)) }));
      const grid = [], z = this.data.floor;
      for (let k = -8; k <= 8; k++) for (const line of [[k / 4, -2, k / 4, 2], [-2, k / 4, 2, k / 4]])
        grid.push(line[0], line[1], z, 0, 0, 1, line[2], line[3], z, 0, 0, 1);
      this.grid = buffered(new Float32Array(grid));
      gl.enable(gl.DEPTH_TEST);
      gl.enable(gl.BLEND);
      gl.blendFunc(gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    }
    camera(width, height) {
      const far = (this.radius / this.zoom) * 1.9 * Math.max(1, (0.9 * height) / width);
      const [cy, sy, cp, sp] = [Math.cos(this.yaw), Math.sin(this.yaw), Math.cos(this.pitch), Math.sin(this.pitch)];
      this.toward = [cp * cy, cp * sy, sp];
      const right = [-sy, cy, 0], up = [-sp * cy, -sp * sy, cp], eye = this.centre.map((v, i) => v + far * this.toward[i]);
      const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
      const view = new Float32Array([0, 1, 2].flatMap((i) => [right[i], up[i], this.toward[i], 0]).concat([-dot(right, eye), -dot(up, eye), -dot(this.toward, eye), 1]));
      const f = 2.1, near = far / 50, end = far * 10;
      const lens = new Float32Array([(f * height) / width, 0, 0, 0, 0, f, 0, 0, 0, 0, (end + near) / (near - end), -1, 0, 0, (2 * end * near) / (near - end), 0]);
      return times(lens, view);
    }
    pose(link) {
      const at = Math.min(Math.max(((this.time - this.data.start) / (this.data.stop - this.data.start || 1)) * (this.count - 1), 0), this.count - 1);
      const k = Math.min(Math.floor(at), this.count - 2), t = at - k, first = 7 * (k * this.data.links + link), next = first + 7 * this.data.links;
      return posed([0, 1, 2, 3, 4, 5, 6].map((i) => this.frames[first + i] * (1 - t) + this.frames[next + i] * t));
    }
    draw() {
      const scale = window.devicePixelRatio || 1, width = this.solid.clientWidth, height = this.solid.clientHeight;
      if (!width || !height) return;
      for (const canvas of [this.solid, this.lines]) {
        if (canvas.width !== Math.round(width * scale)) canvas.width = Math.round(width * scale);
        if (canvas.height !== Math.round(height * scale)) canvas.height = Math.round(height * scale);
      }
      const look = this.camera(width, height);
      const poses = Array.from({ length: this.data.links }, (_, k) => this.pose(k));
      if (this.gl) this.drawSolid(look, poses);
      this.drawWay(look, width, height, scale, turned(poses[this.data.flange], this.data.tcp));
      this.figure.dataset.time = this.time.toFixed(3);
    }
    drawSolid(look, poses) {
      const gl = this.gl, s = this.slots;
      gl.viewport(0, 0, this.solid.width, this.solid.height);
      gl.clearColor(0, 0, 0, 0);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      gl.uniformMatrix4fv(s.look, false, look);
      gl.uniform3fv(s.toward, this.toward);
      const shape = ([buffer, count], body, tint, mode) => {
        gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
        for (const [slot, offset] of [[s.place, 0], [s.normal, 12]]) {
          gl.enableVertexAttribArray(slot);
          gl.vertexAttribPointer(slot, 3, gl.FLOAT, false, 24, offset);
        }
        gl.uniformMatrix4fv(s.body, false, body);
        gl.uniform4fv(s.tint, tint);
        gl.drawArrays(mode, 0, count);
      };
      for (const b of this.bodies) shape(b.buffer, times(poses[b.link], b.own), [...LOOKS[b.look], 1], gl.TRIANGLES);
      shape(this.grid, posed([0, 0, 0, 0, 0, 0, 1]), [0.5, 0.5, 0.5, 0.35], gl.LINES);
    }
    drawWay(look, width, height, scale, tip) {
      const pen = this.lines.getContext("2d"), screen = (x, y, z) => {
        const w = look[3] * x + look[7] * y + look[11] * z + look[15];
        return [0, 1].map((i) => (look[i] * x + look[4 + i] * y + look[8 + i] * z + look[12 + i]) / w).map((v, i) => (i ? (1 - v) / 2 * height : (1 + v) / 2 * width));
      };
      pen.setTransform(scale, 0, 0, scale, 0, 0);
      pen.clearRect(0, 0, width, height);
      pen.lineCap = "round";
      const ink = getComputedStyle(this.figure).color, points = [];
      if (this.reference) {
        pen.beginPath();
        for (let k = 0; k < this.reference.length; k += 3) pen.lineTo(...screen(...this.reference.slice(k, k + 3)));
        pen.strokeStyle = ink;
        pen.lineWidth = 1;
        pen.stroke();
      }
      for (let k = 0; k < this.way.length; k += 3) points.push(screen(this.way[k], this.way[k + 1], this.way[k + 2]));
      pen.lineWidth = 2.5;
      for (let k = 0; k + 1 < points.length; k++) {
        const f = this.field;
        pen.strokeStyle = f ? colour((f.values[k] - f.low) / (f.high - f.low || 1)) : "#4593ce";
        pen.beginPath();
        pen.moveTo(...points[k]);
        pen.lineTo(...points[k + 1]);
        pen.stroke();
      }
      pen.beginPath();
      pen.arc(...screen(...tip), 5, 0, 2 * Math.PI);
      pen.fillStyle = "#ffffff";
      pen.fill();
      pen.lineWidth = 2;
      pen.strokeStyle = "#c82828";
      pen.stroke();
      this.figure.dataset.tip = tip.map((v) => v.toFixed(5)).join();
    }
    at(time) {
      this.time = Math.min(Math.max(time, this.data.start), this.data.stop);
      this.slider.value = (1000 * (this.time - this.data.start)) / (this.data.stop - this.data.start || 1);
      let text = `${this.time.toFixed(2)} s`;
      if (this.field) {
        const k = Math.round(((this.time - this.data.start) / (this.data.stop - this.data.start || 1)) * (this.count - 1));
        text += `, ${this.field.values[k].toFixed(this.field.digits)} ${this.field.unit}`;
      }
      this.clock.textContent = text;
      this.draw();
      window.dispatchEvent(new CustomEvent("armtime", { detail: this.time }));
    }
    play(on) {
      this.playing = on;
      this.button.textContent = on ? "\u275A\u275A" : "\u25B6";
      if (!on) return;
      if (this.time >= this.data.stop) this.time = this.data.start;
      let last = null;
      const next = (now) => {
        if (!this.playing) return;
        const step = last === null ? 0 : (now - last) / 1000;
        last = now;
        this.at(this.time + step);
        if (this.time >= this.data.stop) this.play(false);
        else requestAnimationFrame(next);
      };
      requestAnimationFrame(next);
    }
    wire() {
      const find = (name) => this.figure.querySelector(name);
      this.button = find(".play");
      this.slider = find(".slider");
      this.clock = find(".clock");
      const select = find(".field"), legend = find(".legend");
      this.button.addEventListener("click", () => this.play(!this.playing));
      this.slider.addEventListener("input", () => {
        this.play(false);
        this.at(this.data.start + (this.slider.value / 1000) * (this.data.stop - this.data.start));
      });
      this.fields.forEach((f, k) => select.append(new Option(f.unit ? `${f.name} [${f.unit}]` : f.name, k)));
      const choose = () => {
        this.field = this.fields[select.value || 0] || null;
        legend.hidden = select.parentElement.hidden = !this.field;
        if (!this.field) return;
        const bar = document.createElement("i"), ends = document.createElement("span");
        bar.style.background = `linear-gradient(90deg, ${RAMP.map((_, k) => colour(k / (RAMP.length - 1))).join()})`;
        for (const end of ["low", "high"]) ends.append(Object.assign(document.createElement("b"), { textContent: this.field[end].toFixed(this.field.digits) }));
        legend.replaceChildren(bar, ends, `${this.field.name}${this.field.unit ? ` [${this.field.unit}]` : ""}`);
      };
      select.addEventListener("change", () => { choose(); this.at(this.time); });
      choose();
      for (const button of this.figure.querySelectorAll("[data-view]")) button.addEventListener("click", () => {
        const view = button.dataset.view;
        if (view in TURNS) [this.yaw, this.pitch] = TURNS[view];
        else this.zoom = Math.min(Math.max(this.zoom * (view === "near" ? 1.3 : 1 / 1.3), 0.3), 12);
        this.draw();
      });
      let from = null;
      this.lines.addEventListener("pointerdown", (e) => { from = [e.clientX, e.clientY]; this.lines.setPointerCapture(e.pointerId); });
      this.lines.addEventListener("pointermove", (e) => {
        if (!from) return;
        this.yaw -= (e.clientX - from[0]) * 0.008;
        this.pitch = Math.min(Math.max(this.pitch + (e.clientY - from[1]) * 0.008, -1.5), 1.5);
        from = [e.clientX, e.clientY];
        this.draw();
      });
      for (const name of ["pointerup", "pointercancel"]) this.lines.addEventListener(name, () => { from = null; });
    }
  }
  for (const figure of document.querySelectorAll("figure.arm")) figure.arm = new Arm(figure);
})();
