// Zoom of figures along x, in place: curves are stretched, ticks written anew; a time cursor follows the arm.
"use strict";
(() => {
  const NS = "http://www.w3.org/2000/svg";
  const made = (name, attributes, parent) => {
    const element = document.createElementNS(NS, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    parent.append(element);
    return element;
  };
  const ticks = (low, high, count) => {
    const rough = (high - low) / count, power = 10 ** Math.floor(Math.log10(rough));
    const step = power * [1, 2, 5, 10].find((f) => f * power >= rough);
    const found = [];
    for (let v = Math.ceil(low / step) * step; v <= high + 1e-9 * step; v += step) found.push(v);
    return found.map((v) => [v, v.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9)))]);
  };

  class Axes {
    constructor(svg, place) {
      this.svg = svg;
      this.place = place;
      this.group = svg.querySelector(`[id="${svg.id}-${place.id}"]`);
      this.curves = [];
      this.own = [];
      for (const path of this.group.querySelectorAll("[clip-path]")) {
        const tick = path.closest('[id*="xtick_"], [id*="ytick_"]');
        if (tick) continue;
        const frame = document.createElementNS(NS, "g");
        frame.setAttribute("clip-path", path.getAttribute("clip-path"));
        path.removeAttribute("clip-path");
        path.replaceWith(frame);
        frame.append(path);
        path.style.vectorEffect = "non-scaling-stroke";
        this.curves.push(path);
      }
      this.own = [...this.group.querySelectorAll('[id*="xtick_"]')];
      this.labelled = this.own.some((tick) => tick.querySelector("text"));
      this.fresh = made("g", {}, this.group);
      this.cursor = made("line", { class: "cursor", visibility: "hidden" }, this.group);
    }
    show([low, high]) {
      this.view = [low, high];
      const [left, top, right, bottom] = this.place.box, [x0, x1] = this.place.x;
      const scale = (x1 - x0) / (high - low);
      const start = left - ((low - x0) / (x1 - x0)) * (right - left) * scale;
      const whole = low === x0 && high === x1;
      for (const curve of this.curves) {
        if (whole) curve.removeAttribute("transform");
        else curve.setAttribute("transform", `matrix(${scale} 0 0 1 ${start - left * scale} 0)`);
      }
      for (const tick of this.own) tick.style.display = whole ? "" : "none";
      this.fresh.replaceChildren();
      if (whole) return;
      for (const [value, text] of ticks(low, high, 6)) {
        const x = this.at(value);
        made("line", { x1: x, x2: x, y1: top, y2: bottom, stroke: "var(--grid)", "stroke-width": 0.6 }, this.fresh);
        if (!this.labelled) continue;
        made("text", { x, y: bottom + 14.5, "text-anchor": "middle", "font-size": 10 }, this.fresh).textContent = text;
      }
    }
    at(value) {
      const [left, , right] = this.place.box, [low, high] = this.view || this.place.x;
      return left + ((value - low) / (high - low)) * (right - left);
    }
    value(x) {
      const [left, , right] = this.place.box, [low, high] = this.view || this.place.x;
      return low + ((Math.min(Math.max(x, left), right) - left) / (right - left)) * (high - low);
    }
    mark(time) {
      const x = this.at(time), [left, top, right, bottom] = this.place.box;
      const inside = x >= left && x <= right;
      this.cursor.setAttribute("visibility", inside ? "visible" : "hidden");
      for (const [key, v] of [["x1", x], ["x2", x], ["y1", top], ["y2", bottom]]) this.cursor.setAttribute(key, v);
    }
  }

  const groups = [];
  for (const figure of document.querySelectorAll(".zoomable")) {
    const all = [];
    for (const svg of figure.querySelectorAll("svg[data-axes]")) {
      const axes = JSON.parse(svg.dataset.axes).map((place) => new Axes(svg, place));
      all.push(...axes);
      const where = (event) => {
        const box = svg.getBoundingClientRect(), view = svg.viewBox.baseVal;
        return [((event.clientX - box.left) / box.width) * view.width, ((event.clientY - box.top) / box.height) * view.height];
      };
      let from = null, over = null, pick = null;
      svg.addEventListener("pointerdown", (event) => {
        const [x, y] = where(event);
        over = axes.find((a) => x >= a.place.box[0] && x <= a.place.box[2] && y >= a.place.box[1] && y <= a.place.box[3]);
        if (!over) return;
        from = x;
        svg.setPointerCapture(event.pointerId);
        pick = made("rect", { class: "pick", y: over.place.box[1], height: over.place.box[3] - over.place.box[1], x, width: 0 }, svg);
      });
      svg.addEventListener("pointermove", (event) => {
        if (from === null) return;
        const [x] = where(event), [left, , right] = over.place.box, to = Math.min(Math.max(x, left), right);
        pick.setAttribute("x", Math.min(from, to));
        pick.setAttribute("width", Math.abs(to - from));
      });
      const end = (event) => {
        if (from === null) return;
        const [x] = where(event), view = [over.value(from), over.value(x)].sort((a, b) => a - b);
        pick.remove();
        if (event.type === "pointerup" && Math.abs(x - from) > 6) all.forEach((a) => a.show(view));
        from = null;
      };
      svg.addEventListener("pointerup", end);
      svg.addEventListener("pointercancel", end);
      svg.addEventListener("dblclick", () => all.forEach((a) => a.show(a.place.x)));
    }
    groups.push(all);
  }
  window.addEventListener("armtime", (event) => groups.forEach((all) => all.forEach((a) => a.mark(event.detail))));
})();
