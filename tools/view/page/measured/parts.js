// Which parts of a scene hang together, so that the view does not go after what was cut off or broke.
import { NOWHERE } from "../messages.js";

/** Returns a function that finds the first particle of a part, and one that joins two parts. */
function union(count) {
  const parent = Uint32Array.from({ length: count }, (_, i) => i);
  const find = (i) => {
    while (parent[i] !== i) i = parent[i] = parent[parent[i]];
    return i;
  };
  return { find, join: (a, b) => { parent[find(a)] = find(b); } };
}

/** Joins what rods hold together, without those that are gone. Returns parts and which of them hang from what is fixed. */
function hold({ rods, islands }, gone) {
  const parts = union(islands.length), hanging = new Set(), held = [], out = new Set(gone);
  for (let rod = 0; 2 * rod < rods.length; ++rod) {
    const [a, b] = [rods[2 * rod], rods[2 * rod + 1]];
    if (out.has(rod)) continue;
    if (islands[a] !== NOWHERE && islands[b] !== NOWHERE) parts.join(a, b);
    else held.push(islands[a] === NOWHERE ? b : a);
  }
  for (const particle of held) hanging.add(parts.find(particle));
  return { parts, hanging };
}

/**
 * Returns of each particle whether it belongs to what stays of its island: what hangs from something fixed or, if nothing
 * does, the largest part. Islands that joints held together from the start are left whole.
 */
export function whatStays(scene, gone) {
  const { islands } = scene, before = hold(scene, []), now = hold(scene, gone);
  const pieces = new Map(); // of each island: its parts at first, and its parts of now with their sizes
  islands.forEach((island, i) => {
    if (island === NOWHERE) return;
    if (!pieces.has(island)) pieces.set(island, { first: new Set(), sizes: new Map() });
    const { first, sizes } = pieces.get(island), part = now.parts.find(i);
    first.add(before.parts.find(i));
    sizes.set(part, (sizes.get(part) ?? 0) + 1);
  });
  const stays = new Set();
  for (const { first, sizes } of pieces.values()) {
    const hanging = [...sizes.keys()].filter((part) => now.hanging.has(part));
    const largest = [...sizes.keys()].reduce((most, part) => (sizes.get(part) > sizes.get(most) ? part : most));
    for (const part of first.size > 1 ? sizes.keys() : hanging.length ? hanging : [largest]) stays.add(part);
  }
  return islands.map((island, i) => island === NOWHERE || stays.has(now.parts.find(i)));
}
