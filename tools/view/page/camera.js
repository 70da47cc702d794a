// A camera that orbits a point, and the matrices that it gives. Matrices are column by column, as WebGL has them.

const subtract = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const scaled = (s, a) => [s * a[0], s * a[1], s * a[2]];
const plus = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const unit = (a) => scaled(1 / (Math.hypot(...a) || 1), a);
export const vec = { subtract, cross, dot, scaled, plus, unit };

const FIELD = 0.7; // rad, of the smaller side of the view
const SHARE = 0.85; // of what the view shows, in which things are kept
const PACE = 0.08; // the share of the way that the view goes in a picture
const MOST_SEEN = 500; // particles that are looked at for that
const FAR_APART = 2; // times as far as at first, which no view shows

export class Camera {
  constructor() {
    this.target = [0, 0, 0];
    this.distance = 4;
    this.yaw = 0.35;
    this.pitch = 0.16;
  }

  /** Shows all of a ball, with some room around it. */
  frame({ center, radius, room }) {
    this.target = [...center];
    this.size = this.radius = Math.max(radius, 1e-3);
    this.distance = (room * this.radius) / Math.sin(FIELD / 2);
    this.yaw = 0.35;
    this.pitch = 0.16;
  }

  /** Goes after what leaves the view, as far as it has to, until somebody moves or zooms it. `stays` tells which particles count. */
  follow(positions, thickness, stays) {
    const { low, high } = this.extent(positions, stays);
    this.seen = scaled(0.5, plus(low, high));
    if (!this.radius) return;
    const away = subtract(this.seen, this.target);
    const beyond = Math.hypot(...away) + 0.5 * Math.hypot(...subtract(high, low)) + thickness - SHARE * this.radius;
    const far = Math.hypot(...away);
    if (!(beyond > 0) || !Number.isFinite(far) || far === 0) return;
    // The middle of what is fast does not leave the view.
    const way = Math.max(PACE * Math.min(beyond, far), far - this.radius);
    this.target = plus(this.target, scaled(way / far, away));
  }

  /** Returns two corners of the box around particles, or around the middle half of them where they flew far apart. */
  extent(positions, stays) {
    const seen = [0, 1, 2].map((c) => {
      const out = [], every = 3 * Math.ceil(positions.length / 3 / MOST_SEEN);
      for (let i = 0; i < positions.length; i += every) if (!stays || stays[i / 3]) out.push(positions[i + c]);
      return out.sort((a, b) => a - b);
    });
    const box = (share) => {
      const [low, high] = [share, 1 - share].map((at) => seen.map((list) => list[Math.round(at * (list.length - 1))]));
      return { low, high };
    };
    const all = box(0);
    return Math.hypot(...subtract(all.high, all.low)) > 2 * FAR_APART * this.size ? box(0.25) : all;
  }

  orbit(dx, dy) {
    this.yaw -= 0.006 * dx;
    this.pitch = Math.min(1.55, Math.max(-1.2, this.pitch + 0.006 * dy));
  }

  zoom(factor) {
    this.radius = 0;
    this.distance = Math.min(1e6, Math.max(1e-3, this.distance * factor));
  }

  pan(dx, dy, height) {
    this.radius = 0;
    const { right, up } = this.axes();
    const s = (2 * this.distance * Math.tan(FIELD / 2)) / height;
    this.target = plus(this.target, plus(scaled(-dx * s, right), scaled(dy * s, up)));
  }

  /** Returns the numbers that say what is seen. */
  pose() {
    return [...this.target, this.distance, this.yaw, this.pitch];
  }

  axes() {
    const back = [
      Math.cos(this.pitch) * Math.sin(this.yaw), Math.sin(this.pitch), Math.cos(this.pitch) * Math.cos(this.yaw)];
    const right = unit(cross([0, 1, 0], back));
    return { back, right, up: cross(back, right) };
  }

  /** Returns the matrices of a view of that aspect, and where the eye is. */
  matrices(aspect) {
    const { back, right, up } = this.axes();
    const eye = plus(this.target, scaled(this.distance, back));
    const view = [
      right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0,
      -dot(right, eye), -dot(up, eye), -dot(back, eye), 1];
    const near = this.distance / 200, far = this.distance * 60;
    const f = 1 / Math.tan(FIELD / 2);
    const [fx, fy] = aspect > 1 ? [f / aspect, f] : [f, f * aspect];
    const projection = [
      fx, 0, 0, 0, 0, fy, 0, 0, 0, 0, (far + near) / (near - far), -1, 0, 0, (2 * far * near) / (near - far), 0];
    return { view, projection, eye, right, up, back, fx, fy };
  }

  /** Returns where a point is in a view of `width` times `height` pixels, and how deep; null behind the eye. */
  project(point, width, height) {
    const { eye, right, up, back, fx, fy } = this.matrices(width / height);
    const d = subtract(point, eye);
    const depth = -dot(d, back);
    if (depth <= 0) return null;
    return { x: (width * (1 + (fx * dot(d, right)) / depth)) / 2, y: (height * (1 - (fy * dot(d, up)) / depth)) / 2,
             depth };
  }

  /** Returns the ray through a pixel. */
  ray(x, y, width, height) {
    const { eye, right, up, back, fx, fy } = this.matrices(width / height);
    const sideways = scaled(((2 * x) / width - 1) / fx, right);
    const upwards = scaled((1 - (2 * y) / height) / fy, up);
    return { origin: eye, direction: unit(subtract(plus(sideways, upwards), back)), back };
  }
}
