// Hangs a line with marks from what flies where no ground is seen, so that one sees that it moves, and reads how high it is.
import { rgb } from "../colours.js";
import { makeInstances, PointTexture } from "../gl.js";
import { short } from "../measured/tables.js";

const MARKS = 60; // at most, from what flies on
const STEPS = 25; // marks, at most, that are as long a way as the eye is off
const FIRST = 2; // times the size of a scene is high enough
const LONG = 0.008, THIN = 0.0008; // of the distance of the eye: marks, and all lines

/** Returns how high the ground is over or below a place, or none where there is none. */
export function groundAt({ planes, hasFloor, solid }, [x, y, z]) {
  let level = Infinity;
  const take = (high) => { if (Math.abs(high - y) < Math.abs(level - y)) level = high; };
  if (hasFloor)
    for (const { normal: n, offset } of planes) if (n[1] > 0.5) take((offset - n[0] * x - n[2] * z) / n[1]);
  for (let i = 0; i < solid.length; i += 18) { // three corners and their normals
    const ax = solid[i], ay = solid[i + 1], az = solid[i + 2];
    const bx = solid[i + 6] - ax, bz = solid[i + 8] - az, cx = solid[i + 12] - ax, cz = solid[i + 14] - az, area = bx * cz - cx * bz;
    const v = ((x - ax) * cz - cx * (z - az)) / area, w = (bx * (z - az) - (x - ax) * bz) / area;
    if (v >= 0 && w >= 0 && v + w <= 1) take(ay + v * (solid[i + 7] - ay) + w * (solid[i + 13] - ay));
  }
  return level < Infinity ? level : null;
}

export class Plummet {
  constructor(gl) {
    const count = MARKS + 1;
    this.gl = gl;
    this.points = new PointTexture(gl);
    this.sticks = makeInstances(gl, [[2, Uint32Array.from({ length: 2 * count }, (_, i) => i), true], [1, new Float32Array(count).fill(1)],
                                     [4, new Float32Array(4 * count)]]);
    this.ground = null;
  }

  /**
   * Returns from where the line hangs, how high that is and how far marks are apart, with words for it; none where one can
   * do without. `place` is what the view goes after.
   */
  from(model, camera, place, { width, height }) {
    this.ground = groundAt(model, place) ?? this.ground; // beyond its edge it counts from there
    const level = this.ground ?? model.center[1], high = place[1] - level;
    if (Math.abs(high) < FIRST * model.radius) return null;
    const foot = camera.project([place[0], level, place[2]], width, height);
    if (foot && foot.y > 0 && foot.y < height) return null;
    const step = 10 ** Math.ceil(Math.log10(camera.distance / STEPS));
    const words = `${short(Math.abs(high))} m ${high > 0 ? "above" : "below"} ${this.ground === null ? "where it began" : "the ground"}; `
      + `marks are ${short(step)} m apart`;
    return { place, high, step, words };
  }

  /** Draws the line. `use` makes a program ready, whose lines are as thick as it is told. */
  draw(use, camera, { place: [x, y, z], high, step }) {
    const gl = this.gl, { right } = camera.axes(), { distance } = camera, points = new Float32Array(8 * (MARKS + 1));
    const way = Math.sign(high), last = Math.floor(Math.abs(high) / step); // marks count from the ground
    const count = Math.min(MARKS, last + 1);
    const put = (i, at) => points.set(at, 4 * i);
    put(0, [x, y, z]);
    put(1, [x, y - way * Math.min(Math.abs(high), MARKS * step), z]);
    for (let k = 0; k < count; ++k) {
      const mark = last - k, long = (mark % 10 === 0 ? 3 : mark % 5 === 0 ? 2 : 1) * LONG * distance, at = y - high + way * mark * step;
      for (const side of [0, 1]) put(2 * k + 2 + side, [x + (2 * side - 1) * long * right[0], at, z + (2 * side - 1) * long * right[2]]);
    }
    this.points.fill(points);
    const tints = new Float32Array(4 * (MARKS + 1));
    for (let i = 0; i <= count; ++i) tints.set([...rgb("ink"), 0.6], 4 * i);
    gl.bindBuffer(gl.ARRAY_BUFFER, this.sticks.buffers[2]);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, tints);
    use(THIN * distance);
    gl.bindTexture(gl.TEXTURE_2D, this.points.texture);
    gl.bindVertexArray(this.sticks.array);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, count + 1);
  }
}
