// What a scene looks like: which points there are, and which rods, particles and shapes are drawn between them.
import { groundCorners, hullTriangles, planeSquare } from "./meshes.js";

const MOST_BALLS = 30000;
const SEEN = 0.04; // of the ground at least, so that what is small is seen against something

/** Returns a box without anything in it, and a function that lets it hold a ball. */
function emptyBox() {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  const add = (p, radius = 0) => {
    for (let c = 0; c < 3; ++c) {
      low[c] = Math.min(low[c], p[c] - radius);
      high[c] = Math.max(high[c], p[c] + radius);
    }
  };
  return { low, high, add };
}

const median = (list) => (list.length ? list.sort((a, b) => a - b)[list.length >> 1] : 1);

export class Model {
  constructor(scene) {
    this.scene = scene;
    this.particles = scene.places.length / 3;
    this.rods = scene.rods.length / 2;
    this.places = []; // weighted places behind the particles
    this.measure();
    this.weigh();
    this.buildSticks();
    this.buildBalls();
    this.buildHulls();
    this.buildGround();
  }

  position(i) {
    return this.scene.places.slice(3 * i, 3 * i + 3);
  }

  measure() {
    const { low, high, beyond } = this.bounds();
    this.thickness = beyond;
    const lengths = [];
    for (let i = 0; i < this.rods; ++i) {
      const [a, b] = [this.scene.rods[2 * i], this.scene.rods[2 * i + 1]].map((p) => this.position(p));
      lengths.push(Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]));
    }
    this.center = low.map((l, i) => (l + high[i]) / 2);
    this.solid = groundCorners(this.scene.ground);
    this.radius = Math.max(Math.hypot(...high.map((h, i) => h - low[i])) / 2, SEEN * this.groundRadius(), 1e-3);
    this.length = lengths.length ? median(lengths) : this.radius / 4;
    this.room = 1.2; // so that bars cover none of it
    const anchors = [];
    for (let i = 0; i < this.particles && anchors.length < 3; ++i)
      if (this.scene.masses[i] === null) anchors.push(this.position(i));
    // What hangs from one place swings about it.
    if (anchors.length === 1 && !this.scene.ground.planes.length) {
      let reach = 0;
      for (let i = 0; i < this.particles; ++i) {
        const p = this.position(i);
        reach = Math.max(reach, Math.hypot(p[0] - anchors[0][0], p[1] - anchors[0][1], p[2] - anchors[0][2]));
      }
      this.center = [anchors[0][0], anchors[0][1] - 0.5 * reach, anchors[0][2]];
      this.radius = 0.92 * reach;
      this.room = 1.06; // it swings to where it would be covered only for moments
    }
    this.low = Math.min(low[1], this.center[1] - this.radius);
  }

  /** Returns half the size of the ground that ends somewhere. */
  groundRadius() {
    const { low, high, add } = emptyBox();
    for (let i = 0; i < this.solid.length; i += 6) add(this.solid.subarray(i, i + 3));
    return this.solid.length ? Math.hypot(...high.map((h, c) => h - low[c])) / 2 : 0;
  }

  /** Returns the corners of the smallest box around all that is drawn at first, and how far it goes beyond particles. */
  bounds() {
    const { low, high, add } = emptyBox();
    const { places, capsules, hulls } = this.scene;
    for (let i = 0; i < this.particles; ++i) add(this.position(i));
    const inner = [...low, ...high];
    for (const { a, b, radius } of capsules)
      for (const place of [a, b])
        add(typeof place === "number" ? this.position(place) : this.weighted(places, place.particles, place.weights), radius);
    for (const { particles, weights, radius } of hulls)
      for (let i = 0; i < weights.length; i += 4) add(this.weighted(places, particles, weights.slice(i, i + 4)), radius);
    return { low, high, beyond: Math.max(0, ...[...low, ...high].map((edge, i) => Math.abs(edge - inner[i]))) };
  }

  /** Returns the number of the point of a place, which is a particle or a mean of some. */
  point(place) {
    if (typeof place === "number") return place;
    this.places.push(place);
    return this.particles + this.places.length - 1;
  }

  buildSticks() {
    const { rods, capsules, tackles } = this.scene;
    const thin = Math.max(0.07 * this.length, 0.0025 * this.radius) * (this.scene.has_shapes ? 0.5 : 1);
    const ends = [], radii = [];
    const numberOf = new Map();
    for (let i = 0; i < this.rods; ++i) {
      ends.push(rods[2 * i], rods[2 * i + 1]);
      radii.push(Math.min(thin, 0.2 * this.length));
      numberOf.set(rods[2 * i] + ":" + rods[2 * i + 1], i);
    }
    this.rodRadius = thin;
    this.spheres = [];
    for (const { a, b, radius } of capsules) {
      const rod = numberOf.get(a + ":" + b) ?? numberOf.get(b + ":" + a);
      const from = this.point(a), to = typeof b === "number" && a === b ? from : this.point(b);
      if (rod !== undefined) radii[rod] = radius;
      else if (from !== to) {
        ends.push(from, to);
        radii.push(radius);
      }
      this.spheres.push([from, radius], [to, radius]);
    }
    for (const chain of tackles)
      for (let i = 1; i < chain.length; ++i) {
        ends.push(chain[i - 1], chain[i]);
        radii.push(0.5 * thin);
      }
    this.ends = new Uint32Array(ends);
    this.stickRadii = new Float32Array(radii);
  }

  buildBalls() {
    const { masses, has_shapes: hasShapes } = this.scene;
    const usual = median(masses.filter((mass) => mass !== null && mass > 0));
    const round = new Map();
    for (const [point, radius] of this.spheres) round.set(point, Math.max(radius, round.get(point) ?? 0));
    const base = 2 * this.rodRadius;
    const many = this.particles > MOST_BALLS;
    for (let i = 0; i < this.particles; ++i) {
      if (round.has(i)) continue;
      const isFixed = masses[i] === null;
      if (many && !isFixed) continue;
      const heavy = isFixed ? 1.3 : Math.min(5, Math.max(0.8, Math.cbrt(masses[i] / usual)));
      round.set(i, base * (hasShapes && !isFixed ? 0.6 : heavy));
    }
    this.balls = new Uint32Array(round.keys());
    this.ballRadii = new Float32Array(round.values());
    this.usualMass = usual;
  }

  /** Finds the last particle that moves, which the slider of the end mass sets, its neighbour, and the range of the others' masses. */
  weigh() {
    const { masses } = this.scene;
    this.end = masses.findLastIndex((mass) => mass !== null);
    const last = this.scene.rods.lastIndexOf(this.end); // rods are pairs of ends
    this.masses = { least: Infinity, most: 0, end: masses[this.end] ?? null, next: masses[this.scene.rods[last ^ 1]] ?? null };
    masses.forEach((mass, i) => {
      if (mass === null || i === this.end) return;
      this.masses.least = Math.min(this.masses.least, mass);
      this.masses.most = Math.max(this.masses.most, mass);
    });
  }

  buildHulls() {
    this.hulls = this.scene.hulls.map(({ particles, weights }) => {
      const points = [];
      for (let i = 0; i < weights.length; i += 4) points.push(weights.slice(i, i + 4));
      const at = points.map((w) => this.weighted(this.scene.places, particles, w));
      return { particles, points, triangles: hullTriangles(at) };
    });
  }

  weighted(places, particles, weights) {
    const p = [0, 0, 0];
    particles.forEach((particle, k) => {
      for (let c = 0; c < 3; ++c) p[c] += weights[k] * places[3 * particle + c];
    });
    return p;
  }

  buildGround() {
    const extent = 14 * this.radius;
    const planes = this.scene.ground.planes;
    this.hasFloor = planes.length > 0;
    // A faint floor gives a sense of space where there is no ground.
    const shown = planes.length > 2 ? planes.filter(({ normal }) => normal[1] > 0.5) : planes;
    const floor = this.hasFloor || this.solid.length ? shown : [{ normal: [0, 1, 0], offset: this.low - 0.15 * this.radius }];
    this.planes = floor.map((plane) => planeSquare(plane, this.center, extent));
    this.extent = extent;
    this.cell = 10 ** Math.round(Math.log10(this.radius / 4));
  }

  /** Returns points for a texture: particles, then weighted places, with a fourth number each. */
  fillPoints(positions, out) {
    for (let i = 0, n = this.particles; i < n; ++i) {
      out[4 * i] = positions[3 * i];
      out[4 * i + 1] = positions[3 * i + 1];
      out[4 * i + 2] = positions[3 * i + 2];
    }
    this.places.forEach(({ particles, weights }, i) => {
      out.set(this.weighted(positions, particles, weights), 4 * (this.particles + i));
    });
  }

  pointCount() {
    return this.particles + this.places.length;
  }

  /** Returns the corners of all hulls where their bodies are now. */
  hullCorners(positions) {
    const out = [];
    for (const { particles, points, triangles } of this.hulls) {
      const at = points.map((w) => this.weighted(positions, particles, w));
      for (const [a, b, c] of triangles) {
        const u = at[b].map((x, k) => x - at[a][k]), v = at[c].map((x, k) => x - at[a][k]);
        const n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        for (const i of [a, b, c]) out.push(...at[i], ...n);
      }
    }
    return new Float32Array(out);
  }
}
