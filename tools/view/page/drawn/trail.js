// The way that an end took, as a smooth curve through where it was shown.
import { vec } from "../camera.js";
import { makeInstances, PointTexture } from "../gl.js";

const FRAMES = 150; // of the way
const PARTS = 6; // of the curve from one frame to the next
const STICKS = PARTS * (FRAMES - 1);
const SHARP = 0.5; // the cosine of a turn that is a blow

/** Returns how fast the way goes at a point, per frame. A blow is a corner, which no curve rounds. */
function slope(before, here, after) {
  if (!before || !after) return null;
  const came = vec.subtract(here.at, before.at), goes = vec.subtract(after.at, here.at);
  const past = here.frame - before.frame, next = after.frame - here.frame;
  if (vec.dot(came, goes) < SHARP * Math.hypot(...came) * Math.hypot(...goes)) return null;
  return vec.scaled(1 / (past + next), vec.plus(vec.scaled(next / past, came), vec.scaled(past / next, goes)));
}

/** Returns points of a curve through those of a way, `PARTS` from each to the next. Frames may be left out between them. */
export function smooth(way) {
  const slopes = way.map((here, i) => slope(way[i - 1], here, way[i + 1])), out = [];
  for (let i = 0; i + 1 < way.length; ++i) {
    const { at: a, frame } = way[i], { at: b } = way[i + 1], long = way[i + 1].frame - frame, chord = vec.subtract(b, a);
    const [leaves, arrives] = [slopes[i], slopes[i + 1]].map((s) => (s ? vec.scaled(long, s) : chord));
    for (let k = 0; k < PARTS; ++k) {
      // Hermite's cubic: two places and two slopes.
      const t = k / PARTS, u = t * (1 - t);
      out.push(a.map((x, c) => x + t * chord[c] + u * ((1 - t) * (leaves[c] - chord[c]) - t * (arrives[c] - chord[c]))));
    }
  }
  if (way.length) out.push(way.at(-1).at);
  return out;
}

export class Trail {
  constructor(gl, radius) {
    const ends = new Uint32Array(2 * STICKS).map((_, i) => (i >> 1) + (i & 1));
    this.gl = gl;
    this.points = new PointTexture(gl);
    this.sticks = makeInstances(gl, [[2, ends, true], [1, new Float32Array(STICKS).fill(radius)], [4, new Float32Array(4 * STICKS)]]);
    this.clear();
  }

  clear() {
    this.way = [];
  }

  add(frame, at) {
    this.way.push({ frame, at: [...at] });
    if (this.way.length > FRAMES) this.way.shift();
  }

  /** Draws it up to what is shown, which may lie between two frames, by a function that makes a program ready. */
  draw(use, colour, shown) {
    const gl = this.gl, way = [...this.way.filter(({ frame }) => frame < shown.frame), shown].slice(-FRAMES), count = PARTS * (way.length - 1);
    if (count <= 0) return;
    const points = new Float32Array(4 * (count + 1));
    smooth(way).forEach((p, i) => points.set(p, 4 * i));
    this.points.fill(points);
    const tints = new Float32Array(4 * STICKS);
    for (let i = 0; i < count; ++i) tints.set([...colour, 0.02 + 0.6 * (i / count) ** 2], 4 * i);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.sticks.buffers[2]);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, tints);
    use();
    gl.bindTexture(gl.TEXTURE_2D, this.points.texture);
    gl.bindVertexArray(this.sticks.array);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count);
  }
}
