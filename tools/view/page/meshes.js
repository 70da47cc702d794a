// Triangles of what does not bend: boxes, hulls, capsules, meshes, landscapes.
import { vec } from "./camera.js";

const { subtract, cross, dot, scaled, plus, unit } = vec;

/** Appends a triangle with its flat normal to a list of corners. */
function pushTriangle(out, a, b, c) {
  const n = unit(cross(subtract(b, a), subtract(c, a)));
  for (const p of [a, b, c]) out.push(...p, ...n);
}

function turned([w, x, y, z], p) {
  const q = [x, y, z];
  const t = scaled(2, cross(q, p));
  return plus(p, plus(scaled(w, t), cross(q, t)));
}

function pushBox(out, { center, half_size: half, orientation }) {
  const corner = (i) => plus(center, turned(orientation, half.map((h, axis) => (i & (1 << axis) ? h : -h))));
  for (const [a, b, c, d] of [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]) {
    pushTriangle(out, corner(a), corner(b), corner(c));
    pushTriangle(out, corner(a), corner(c), corner(d));
  }
}

/** Returns triples of numbers of points whose triangles are the hull of few points, by trying all. */
export function hullTriangles(points) {
  const out = [];
  const size = Math.max(...points.map((p) => Math.hypot(...subtract(p, points[0])))) || 1;
  if (points.length > 48) return out;
  for (let a = 0; a < points.length; ++a)
    for (let b = a + 1; b < points.length; ++b)
      for (let c = b + 1; c < points.length; ++c) {
        const n = cross(subtract(points[b], points[a]), subtract(points[c], points[a]));
        if (Math.hypot(...n) < 1e-9 * size * size) continue;
        const off = points.map((p) => dot(unit(n), subtract(p, points[a])) / size);
        if (off.every((d) => d < 1e-6)) out.push([a, b, c]);
        else if (off.every((d) => d > -1e-6)) out.push([a, c, b]);
      }
  return out;
}

function pushCapsule(out, { a, b, radius }) {
  const along = unit(Math.hypot(...subtract(b, a)) > 0 ? subtract(b, a) : [0, 1, 0]);
  const u = unit(cross(along, Math.abs(along[1]) < 0.9 ? [0, 1, 0] : [1, 0, 0]));
  const w = cross(along, u);
  const rings = 12, around = 24;
  const at = (i, j) => {
    const t = -Math.PI / 2 + (Math.PI * i) / rings, f = (2 * Math.PI * j) / around;
    const n = plus(scaled(Math.cos(t), plus(scaled(Math.cos(f), u), scaled(Math.sin(f), w))), scaled(Math.sin(t), along));
    return { n, p: plus(i <= rings / 2 ? a : b, scaled(radius, n)) };
  };
  for (let i = 0; i < rings; ++i)
    for (let j = 0; j < around; ++j)
      for (const corners of [[at(i, j), at(i, j + 1), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i + 1, j)]])
        for (const { p, n } of corners) out.push(...p, ...n);
}

function pushHeights(out, { corner, cell_x: x, cell_z: z, columns, heights }) {
  const at = (i, j) => plus(corner, [i * x, heights[j * columns + i], j * z]);
  for (let j = 0; j + 1 < heights.length / columns; ++j)
    for (let i = 0; i + 1 < columns; ++i) {
      pushTriangle(out, at(i, j), at(i + 1, j + 1), at(i + 1, j));
      pushTriangle(out, at(i, j), at(i, j + 1), at(i + 1, j + 1));
    }
}

/** Returns all ground but planes as corners of triangles. */
export function groundCorners(ground) {
  const out = [];
  ground.boxes.forEach((box) => pushBox(out, box));
  ground.capsules.forEach((capsule) => pushCapsule(out, capsule));
  for (const { points } of ground.hulls)
    for (const t of hullTriangles(points)) pushTriangle(out, ...t.map((i) => points[i]));
  for (const { vertices, triangles } of ground.meshes)
    for (const t of triangles) pushTriangle(out, ...t.map((i) => vertices[i]));
  ground.heights.forEach((field) => pushHeights(out, field));
  return new Float32Array(out);
}

/** Returns a large square of a plane, and two directions along it. */
export function planeSquare({ normal, offset }, center, extent) {
  const n = unit(normal);
  const u = unit(cross(Math.abs(n[0]) < 0.9 ? [1, 0, 0] : [0, 0, 1], n)), v = cross(n, u);
  const middle = plus(center, scaled(offset - dot(n, center), n));
  const corner = (i, j) => plus(middle, plus(scaled(i * extent, u), scaled(j * extent, v)));
  const out = [];
  pushTriangle(out, corner(-1, -1), corner(1, -1), corner(1, 1));
  pushTriangle(out, corner(-1, -1), corner(1, 1), corner(-1, 1));
  return { corners: new Float32Array(out), middle, u, v, normal: n, offset };
}
