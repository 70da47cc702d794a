// Draws the worlds, over each other or side by side.
import { diverging, islandColour, mixed, rgb, sideColour } from "./colours.js";
import { Plummet } from "./drawn/plummet.js";
import { Trail } from "./drawn/trail.js";
import { widthOf } from "./drawn/widths.js";
import { makeInstances, makeProgram, makeTriangles, PointTexture } from "./gl.js";
import { whatStays } from "./measured/parts.js";
import { NOWHERE } from "./messages.js";
import { Model } from "./model.js";
import * as shaders from "./shaders.js";

export class Painter {
  constructor(canvas) {
    this.canvas = canvas;
    const gl = canvas.getContext("webgl2", { alpha: false, antialias: true, stencil: true });
    if (!gl) throw new Error("This browser shows no WebGL2, which the page draws with.");
    this.gl = gl;
    this.rod = makeProgram(gl, shaders.rodVertex, shaders.rodFragment);
    this.ball = makeProgram(gl, shaders.ballVertex, shaders.ballFragment);
    this.solid = makeProgram(gl, shaders.solidVertex, shaders.solidFragment);
    this.grid = makeProgram(gl, shaders.gridVertex, shaders.gridFragment);
    this.sides = [];
    this.overlay = true;
    this.top = 0; // of the canvas is covered by words, in its pixels
    this.trails = true;
    this.colour = "world";
    this.held = -1;
    this.chosen = -1;
  }

  /** Shows a scene. One that `goesOn` has a thrown ball more, and counts as large as it began. */
  setScene(scene, goesOn) {
    const gl = this.gl;
    this.model = new Model(scene);
    this.size = goesOn ? this.size : this.model.radius;
    this.sides = [];
    this.plummet = new Plummet(gl);
    this.flies = null; // what is out of sight of the ground, where that is drawn
    this.gone = { count: 0, stays: null };
    this.ground = this.model.solid.length ? makeTriangles(gl, this.model.solid) : null;
    this.planes = this.model.planes.map((plane) => ({ ...plane, triangles: makeTriangles(gl, plane.corners) }));
    this.end = this.model.end;
    return this.model;
  }

  /** Sizes of particles follow their masses. */
  setEndMass(mass) {
    if (!this.model || this.end < 0 || this.model.scene.has_shapes) return;
    const heavy = Math.min(5, Math.max(0.8, Math.cbrt(mass / this.model.usualMass)));
    const at = this.model.balls.indexOf(this.end);
    if (at < 0) return;
    this.model.ballRadii[at] = 2 * this.model.rodRadius * heavy;
    const gl = this.gl;
    for (const side of this.sides) {
      gl.bindBuffer(gl.ARRAY_BUFFER, side.balls.buffers[1]);
      gl.bufferSubData(gl.ARRAY_BUFFER, 0, this.model.ballRadii);
    }
  }

  makeSide() {
    const gl = this.gl, model = this.model;
    const sticks = model.stickRadii.length, balls = model.balls.length;
    return {
      points: new PointTexture(gl),
      place: new Float32Array(4 * model.pointCount()),
      stickTints: new Float32Array(4 * sticks),
      ballTints: new Float32Array(4 * balls),
      sticks: makeInstances(gl, [[2, model.ends, true], [1, model.stickRadii], [4, new Float32Array(4 * sticks)]]),
      balls: makeInstances(gl, [[1, model.balls, true], [1, model.ballRadii], [4, new Float32Array(4 * balls)]]),
      hulls: model.hulls.length ? makeTriangles(gl, new Float32Array(6)) : null,
      trail: new Trail(gl, 0.6 * model.rodRadius),
    };
  }

  clearTrails() {
    for (const side of this.sides) side.trail.clear();
  }

  /** Takes a frame. `blend` in [0, 1] leads from the frame before, if there is one, to it. */
  update(frame, before, blend) {
    const gl = this.gl, model = this.model;
    while (this.sides.length < frame.sides.length) this.sides.push(this.makeSide());
    this.sides.length = frame.sides.length;
    this.shownFrame = before ? before.frame + blend * (frame.frame - before.frame) : frame.frame;
    frame.sides.forEach((from, i) => {
      const side = this.sides[i];
      if (from.positions.length !== 3 * model.particles) return;
      let positions = from.positions;
      const old = before?.sides[i]?.positions;
      if (blend < 1 && old?.length === positions.length) positions = old.map((x, k) => x + blend * (positions[k] - x));
      side.positions = positions;
      side.gone = from.gone;
      model.fillPoints(positions, side.place);
      side.points.fill(side.place);
      this.tint(side, from, i, frame.sides.length);
      if (side.hulls) {
        const corners = model.hullCorners(positions);
        gl.bindBuffer(gl.ARRAY_BUFFER, side.hulls.buffer);
        gl.bufferData(gl.ARRAY_BUFFER, corners, gl.DYNAMIC_DRAW);
        side.hulls.count = corners.length / 6;
      }
    });
  }

  /** Tells which particles of the first world belong to what rods that are gone have left whole. */
  whatStays() {
    const rods = this.sides[0]?.gone ?? [];
    if (rods.length !== this.gone.count) this.gone = { count: rods.length, stays: whatStays(this.model.scene, rods) };
    return this.gone.count ? this.gone.stays : null;
  }

  /** Takes note of where ends are, for their trails. */
  leaveTrail(frame) {
    if (this.end < 0) return;
    frame.sides.forEach(({ positions }, i) => this.sides[i]?.trail.add(frame.frame, positions.slice(3 * this.end, 3 * this.end + 3)));
  }

  tint(side, from, number, count) {
    const gl = this.gl, model = this.model, { islands, rods } = model.scene;
    const own = sideColour(number, count), back = rgb("back"), fixed = rgb("fixed");
    const byValue = this.colour === "strain" || this.colour === "tension";
    const byPlace = { color: model.scene.colors, lane: model.scene.lanes }[this.colour];
    const largest = this.colour === "strain" ? Math.max(from.largest, 1e-4) : Math.max(from.largest, 1e-9);
    const sleeper = mixed(own, back, 0.72);
    const base = (particle) => {
      const asleep = from.flags[particle] & 1;
      if (this.colour === "sleep") return asleep ? mixed(rgb("ink"), back, 0.75) : diverging(0.8);
      if (this.colour === "island" && islands[particle] !== NOWHERE) {
        const colour = islandColour(islands[particle]);
        return asleep ? mixed(colour, back, 0.6) : colour;
      }
      return asleep ? sleeper : own;
    };
    const tints = side.stickTints;
    for (let i = 0; i < model.stickRadii.length; ++i) {
      const a = model.ends[2 * i], b = model.ends[2 * i + 1];
      const movable = a < model.particles && !(from.flags[a] & 2) ? a : b;
      let colour = base(movable < model.particles ? movable : 0);
      if (byValue && i < model.rods && from.values.length) {
        const value = from.values[i];
        colour = Number.isNaN(value) ? mixed(own, back, 0.6) : diverging(value / largest);
        if (from.flags[movable] & 1) colour = mixed(colour, back, 0.6);
      }
      else if (byPlace && i < model.rods) {
        colour = byPlace[i] === NOWHERE ? mixed(own, back, 0.7) : islandColour(byPlace[i]);
        if (from.flags[movable] & 1) colour = mixed(colour, back, 0.6);
      }
      if (i === this.chosen) colour = rgb("ink");
      tints.set(colour, 4 * i);
      tints[4 * i + 3] = 1;
    }
    for (const rod of from.gone) tints[4 * rod + 3] = 0;
    const balls = side.ballTints;
    for (let i = 0; i < model.balls.length; ++i) {
      const particle = model.balls[i];
      const isHeld = particle === this.held;
      const colour = isHeld ? rgb("ink") : from.flags[particle] & 2 ? fixed
        : byValue || byPlace ? mixed(own, back, 0.25) : base(particle < model.particles ? particle : 0);
      balls.set(colour, 4 * i);
      balls[4 * i + 3] = 1;
    }
    for (const [buffer, data] of [[side.sticks.buffers[2], tints], [side.balls.buffers[2], balls]]) {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferSubData(gl.ARRAY_BUFFER, 0, data);
    }
  }

  /** Returns the rectangles of the canvas, in its pixels, that show worlds, and which. */
  viewports() {
    const { width, height } = this.canvas, n = Math.max(1, this.sides.length);
    if (this.overlay || n === 1) return [{ x: 0, y: 0, width, height, shown: this.sides.map((_, i) => i) }];
    if (width > height) return this.sides.map((_, i) => ({ x: Math.floor((i * width) / n), y: 0, width: Math.floor(width / n), height, shown: [i] }));
    // Words would cover the first of those that lie below each other.
    const top = Math.min(this.top, height / 2), each = Math.floor((height - top) / n);
    return this.sides.map((_, i) => ({ x: 0, y: Math.floor(top) + i * each, width, height: each, shown: [i] }));
  }

  /** Returns what changes where a frame is seen another way. */
  look(camera, blend) {
    const { width, height } = this.canvas;
    return [width, height, this.top, this.overlay, this.trails, this.colour, this.held, this.chosen, camera.pose(), blend].join();
  }

  draw(camera) {
    const gl = this.gl, back = rgb("back");
    gl.viewport(0, 0, this.canvas.width, this.canvas.height);
    gl.disable(gl.SCISSOR_TEST);
    gl.clearColor(...back, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT | gl.STENCIL_BUFFER_BIT);
    if (!this.model) return;
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    this.flies = null;
    for (const port of this.viewports()) {
      gl.viewport(port.x, this.canvas.height - port.y - port.height, port.width, port.height);
      const matrices = camera.matrices(port.width / port.height);
      this.drawGround(matrices);
      // The first world is what others are compared with: a ghost behind them.
      for (const i of port.shown) this.drawShadow(matrices, this.sides[i]);
      for (const i of port.shown) this.drawSide(matrices, i, port.shown.length);
      this.drawHeight(matrices, camera, port);
    }
  }

  /** Hangs a line from what the view goes after, if it flies. */
  drawHeight(matrices, camera, port) {
    const flies = camera.seen && this.plummet.from(this.model, camera, camera.seen, port);
    if (!flies) return;
    this.plummet.draw((scale) => this.use(this.rod, matrices, { flatColor: 1, scale }), camera, flies);
    this.flies ??= flies;
  }

  use({ program, uniforms }, matrices, more = {}) {
    const gl = this.gl;
    gl.useProgram(program);
    gl.uniformMatrix4fv(uniforms.view, false, matrices.view);
    gl.uniformMatrix4fv(uniforms.projection, false, matrices.projection);
    const set = { shift: [0, 0, 0], flatten: [0, 1, 0, 1e9], alpha: 1, scale: 1, flatColor: 0, ...more };
    for (const [name, value] of Object.entries(set)) {
      if (!uniforms[name]) continue;
      if (Array.isArray(value)) gl[`uniform${value.length}fv`](uniforms[name], value);
      else gl.uniform1f(uniforms[name], value);
    }
  }

  drawGround(matrices) {
    const gl = this.gl, model = this.model;
    if (this.ground) {
      this.use(this.solid, matrices, { tint: [...rgb("ground"), 1] });
      gl.bindVertexArray(this.ground.array);
      gl.drawArrays(gl.TRIANGLES, 0, this.ground.count);
    }
    gl.depthMask(false);
    for (const { triangles, middle, u, v } of this.planes) {
      this.use(this.grid, matrices, { tint: [...rgb("grid"), model.hasFloor ? 0.75 : 0.3], center: middle, u, v,
                                      cell: model.cell, extent: model.extent });
      gl.bindVertexArray(triangles.array);
      gl.drawArrays(gl.TRIANGLES, 0, triangles.count);
    }
    gl.depthMask(true);
  }

  drawShadow(matrices, side) {
    const gl = this.gl, plane = this.planes[0];
    if (!side.positions || !plane || plane.normal[1] < 0.5) return;
    gl.enable(gl.STENCIL_TEST);
    gl.stencilFunc(gl.EQUAL, 0, 255);
    gl.stencilOp(gl.KEEP, gl.KEEP, gl.INCR);
    gl.depthMask(false);
    this.use(this.rod, matrices, { flatten: [...plane.normal, plane.offset + 1e-3 * this.model.radius], alpha: 0.16,
                                   flatColor: 1 });
    gl.bindTexture(gl.TEXTURE_2D, side.points.texture);
    gl.bindVertexArray(side.sticks.array);
    gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, side.sticks.count);
    gl.depthMask(true);
    gl.disable(gl.STENCIL_TEST);
  }

  /** Draws a world, which may be one of several over each other. */
  drawSide(matrices, number, count) {
    const gl = this.gl, side = this.sides[number], isGhost = count > 1 && number === 0 && this.colour === "world";
    if (!side.positions) return;
    const { level, rods, balls } = widthOf(number, count, this.model.scene.has_shapes);
    if (isGhost) gl.depthMask(false);
    gl.enable(gl.POLYGON_OFFSET_FILL);
    gl.polygonOffset(-level, -4 * level);
    for (const [program, instances, scale] of [[this.rod, side.sticks, rods], [this.ball, side.balls, balls]]) {
      this.use(program, matrices, { alpha: isGhost ? 0.55 : 1, scale });
      gl.bindTexture(gl.TEXTURE_2D, side.points.texture);
      gl.bindVertexArray(instances.array);
      gl.drawArraysInstanced(gl.TRIANGLE_STRIP, 0, 4, instances.count);
    }
    gl.disable(gl.POLYGON_OFFSET_FILL);
    if (side.hulls) {
      this.use(this.solid, matrices, { tint: [...sideColour(number, this.sides.length), isGhost ? 0.4 : 1] });
      gl.bindVertexArray(side.hulls.array);
      gl.drawArrays(gl.TRIANGLES, 0, side.hulls.count);
    }
    if (this.trails) this.drawTrail(matrices, side, number);
    gl.depthMask(true);
  }

  drawTrail(matrices, side, number) {
    if (this.model.particles > 2000 || this.end < 0) return;
    const shown = { frame: this.shownFrame, at: [...side.positions.subarray(3 * this.end, 3 * this.end + 3)] };
    this.gl.depthMask(false);
    side.trail.draw(() => this.use(this.rod, matrices, { flatColor: 1 }), sideColour(number, this.sides.length), shown);
    this.gl.depthMask(true);
  }
}
