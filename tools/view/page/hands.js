// What mouse, touch and pen do: turn the view, and pull, cut, fix, reel and throw.
import { vec } from "./camera.js";
import { requests } from "./messages.js";
import { note, unsay } from "./words/note.js";

const REACH = 28; // pixels within which something is picked
const STILL = 6; // pixels that a click may move, else it is a drag that turns the view

/** What each tool that picks something aims at. */
const AIMS = { cut: "rod", reel: "rod", fix: "particle" };

/** Says what a click missed, where there is any to hit. */
function missed(aim, { rods }) {
  return aim === "rod" && !rods ? "There are no rods in this scene." : `No ${aim} there: click closer to one.`;
}

export class Hands {
  constructor(canvas, painter, camera, page) {
    Object.assign(this, { canvas, painter, camera, page });
    this.tool = "pull";
    this.touches = new Map();
    this.drag = null;
    this.said = ""; // of the last miss
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    for (const end of ["pointerup", "pointercancel"]) canvas.addEventListener(end, (event) => this.up(event));
    canvas.addEventListener("wheel", (event) => {
      event.preventDefault();
      camera.zoom(Math.exp(0.0012 * event.deltaY));
    }, { passive: false });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  /** Returns the view that an event is in and where in it, in CSS pixels. */
  place(event) {
    const box = this.canvas.getBoundingClientRect(), scale = this.canvas.width / box.width;
    const x = (event.clientX - box.left) * scale, y = (event.clientY - box.top) * scale;
    const port = this.painter.viewports().find((p) => x >= p.x && x < p.x + p.width && y >= p.y && y < p.y + p.height);
    return port && { port, x: x - port.x, y: y - port.y, scale };
  }

  nearestParticle({ port, x, y, scale }) {
    let best = null;
    for (const i of port.shown) {
      const positions = this.painter.sides[i]?.positions ?? [];
      for (let k = 0; 3 * k < positions.length; ++k) {
        const at = this.camera.project([positions[3 * k], positions[3 * k + 1], positions[3 * k + 2]], port.width, port.height);
        const far = at ? Math.hypot(at.x - x, at.y - y) : Infinity;
        if (far < REACH * scale && (!best || far < best.far)) best = { particle: k, far, depth: at.depth };
      }
    }
    return best;
  }

  nearestRod({ port, x, y, scale }) {
    const { ends, rods } = this.painter.model;
    let best = null;
    for (const i of port.shown) {
      const { positions, stickTints } = this.painter.sides[i] ?? {};
      if (!positions) continue;
      const at = (k) => this.camera.project([positions[3 * k], positions[3 * k + 1], positions[3 * k + 2]], port.width, port.height);
      for (let rod = 0; rod < rods; ++rod) {
        if (stickTints[4 * rod + 3] === 0) continue;
        const a = at(ends[2 * rod]), b = at(ends[2 * rod + 1]);
        if (!a || !b) continue;
        const dx = b.x - a.x, dy = b.y - a.y;
        const t = Math.min(1, Math.max(0, ((x - a.x) * dx + (y - a.y) * dy) / (dx * dx + dy * dy || 1)));
        const far = Math.hypot(a.x + t * dx - x, a.y + t * dy - y);
        if (far < REACH * scale && (!best || far < best.far)) best = { rod, far };
      }
    }
    return best;
  }

  down(event) {
    this.canvas.setPointerCapture(event.pointerId);
    this.touches.set(event.pointerId, event);
    const at = this.place(event);
    if (!at || !this.painter.model) return;
    if (this.touches.size > 1) {
      this.letGo();
      this.drag = { kind: "pinch" };
      return;
    }
    this.drag = { kind: event.button === 2 || event.shiftKey ? "pan" : "orbit" };
    if (event.button === 0 && !event.shiftKey) this.begin(at, event);
  }

  begin(at, event) {
    const particle = this.tool === "pull" || this.tool === "fix" ? this.nearestParticle(at) : null;
    const rod = this.tool === "cut" || this.tool === "reel" ? this.nearestRod(at) : null;
    if (this.tool === "pull" && particle) {
      this.drag = { kind: "pull", ...particle };
      this.painter.held = particle.particle;
      this.page.sayIfPaused();
      this.pull(at);
    } else if (this.tool === "fix" && particle) {
      this.page.send(this.page.isFixed(particle.particle) ? requests.free(particle.particle) : requests.fix(particle.particle));
      this.drag = null;
    } else if (this.tool === "cut" && rod) {
      this.page.send(requests.cut(rod.rod));
      this.drag = null;
    } else if (this.tool === "reel" && rod) {
      this.painter.chosen = rod.rod;
      this.page.choseRod(rod.rod);
      this.drag = null;
    } else if (this.tool === "throw") {
      this.throwBall(at);
      this.drag = null;
    } else if (AIMS[this.tool]) this.drag.missed = event;
    if (this.drag?.kind !== "orbit") unsay(this.said);
  }

  pull({ port, x, y }) {
    const { origin, direction, back } = this.camera.ray(x, y, port.width, port.height);
    const far = this.drag.depth / -vec.dot(direction, back);
    this.page.send(requests.pull(this.drag.particle, vec.plus(origin, vec.scaled(far, direction))));
  }

  throwBall({ port, x, y }) {
    const { origin, direction } = this.camera.ray(x, y, port.width, port.height);
    const { size } = this.painter;
    const from = vec.plus(origin, vec.scaled(Math.max(0, this.camera.distance - 2.2 * size), direction));
    this.page.send(requests.throwBall(from, vec.scaled(4 * Math.sqrt(9.81 * size), direction), 0.08 * size));
  }

  move(event) {
    const before = this.touches.get(event.pointerId);
    if (!before || !this.drag) return;
    const dx = event.clientX - before.clientX, dy = event.clientY - before.clientY;
    if (this.drag.kind === "pinch") this.pinch(event, dx, dy);
    else if (this.drag.kind === "orbit") this.camera.orbit(dx, dy);
    else if (this.drag.kind === "pan") this.camera.pan(dx, dy, this.canvas.clientHeight);
    else {
      const at = this.place(event);
      if (at) this.pull(at);
    }
    this.touches.set(event.pointerId, event);
  }

  pinch(event, dx, dy) {
    const other = [...this.touches.values()].find((touch) => touch.pointerId !== event.pointerId);
    const before = this.touches.get(event.pointerId);
    if (!other) return;
    const span = (e) => Math.hypot(e.clientX - other.clientX, e.clientY - other.clientY) || 1;
    this.camera.zoom(span(before) / span(event));
    this.camera.pan(dx / 2, dy / 2, this.canvas.clientHeight);
  }

  letGo() {
    if (this.drag?.kind === "pull") this.page.send(requests.release());
    this.painter.held = -1;
    this.drag = null;
  }

  up(event) {
    const from = this.drag?.missed, way = from ? Math.hypot(event.clientX - from.clientX, event.clientY - from.clientY) : Infinity;
    if (way < STILL && event.type === "pointerup") note(this.said = missed(AIMS[this.tool], this.painter.model));
    this.touches.delete(event.pointerId);
    this.letGo();
  }
}
