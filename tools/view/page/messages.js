// Messages of the server, and requests to it. ../README.md has the table of their bytes.

/** The number of no island, which is that of what is fixed, and of no place. */
export const NOWHERE = 4294967295;

const MAGIC = 0x32564c50;
const HEAD = 36;
const SIDE_HEAD = 108;

/** Reads a frame. Its arrays lie in `buffer`; nothing is copied. Throws an Error on other bytes. */
export function decodeFrame(buffer) {
  const view = new DataView(buffer);
  if (buffer.byteLength < HEAD || view.getUint32(0, true) !== MAGIC) throw new Error("this is no frame");
  const flags = view.getUint32(20, true);
  const frame = {
    frame: view.getUint32(4, true),
    time: view.getFloat64(8, true),
    playing: (flags & 1) !== 0,
    replaying: (flags & 2) !== 0,
    reached: view.getFloat32(24, true),
    stepUs: view.getFloat32(28, true),
    frameUs: view.getFloat32(32, true),
    sides: [],
  };
  let at = HEAD;
  for (let i = view.getUint32(16, true); i > 0; --i) at = decodeSide(view, at, frame.sides);
  return frame;
}

function decodeSide(view, at, sides) {
  const u32 = (offset) => view.getUint32(at + offset, true);
  const f32 = (offset) => view.getFloat32(at + offset, true);
  const particles = u32(0), values = u32(4), gone = u32(8);
  const side = {
    islands: u32(12), awake: u32(16), substeps: u32(20), sweeps: u32(24), newton: u32(28),
    hash: view.getBigUint64(at + 32, true),
    stepUs: f32(40), strainRms: f32(44), strainMax: f32(48),
    kinetic: f32(52), potential: f32(56), elastic: f32(60),
    distance: f32(64), largest: f32(68), skipped: u32(72), troubles: u32(76),
    stagesUs: [80, 84, 88, 92, 96, 100, 104].map(f32),
  };
  let from = at + SIDE_HEAD;
  side.positions = new Float32Array(view.buffer, from, 3 * particles);
  from += 12 * particles;
  side.gone = new Uint32Array(view.buffer, from, gone);
  from += 4 * gone;
  side.values = new Float32Array(view.buffer, from, values);
  from += 4 * values;
  side.flags = new Uint8Array(view.buffer, from, particles);
  sides.push(side);
  return from + 4 * Math.ceil(particles / 4);
}

/** Spells a hash as reports do; a dash where a frame has none. */
export function hashText(hash) {
  return hash === 0n ? "–" : "0x" + hash.toString(16).padStart(16, "0");
}

const request = (verb, members = {}) => JSON.stringify({ do: verb, ...members });

/** All that can be asked for. */
export const requests = {
  set: (name, value, side) =>
    request("set", side === undefined ? { name, value: String(value) } : { side, name, value: String(value) }),
  pull: (number, at) => request("pull", { number, at }),
  release: () => request("release"),
  cut: (number) => request("cut", { number }),
  fix: (number) => request("fix", { number }),
  free: (number) => request("free", { number }),
  reel: (name, number, rate) => request("reel", { name, number, value: String(rate) }),
  throwBall: (at, velocity, radius) => request("throw", { at, velocity, value: String(radius) }),
  play: () => request("play"),
  pause: () => request("pause"),
  step: () => request("step"),
  speed: (value) => request("speed", { value: String(value) }),
  reset: () => request("reset"),
  defaults: () => request("defaults"),
  load: (name, text = "") => request("load", text ? { name, value: text } : { name }),
  compare: (name) => request("compare", { name }),
  addSide: (side) => request("add", { side }),
  dropSide: (side) => request("drop", { side }),
  values: (name) => request("values", { name }),
  record: () => request("record"),
};
