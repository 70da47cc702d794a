// Says in words what a comparison of weights shows, and when errors tell nothing more.

const RECENT = 180, ENOUGH = 60; // frames
const NEAR = 1, CLOSE = 3, APART = 10, FAR = 1e4; // percent
const MUCH = 2; // times as far
const ALIKE = 0.1; // of the larger one

const starting = (words) => words[0].toUpperCase() + words.slice(1);

/** Returns whether masses from one to another are so alike that weights hardly differ. */
export const areAlike = (least, most) => most <= (1 + ALIKE) * least;

/** Spells how far a world is from the first, in percent. */
export function percentText(percent) {
  if (!Number.isFinite(percent) || percent > FAR) return "far off";
  return `${percent < 1e-3 ? 0 : Number(percent.toPrecision(2))} % off`;
}

/** Returns the numbers of two worlds behind the first that are relaxed alike but for their weights, by mass and equal; or none. */
export function compared(sides) {
  const found = ["mass", "equal"].map((weights) =>
    sides.findIndex(({ settings }, i) => i > 0 && settings.method === "relax" && settings.weights === weights));
  if (found.includes(-1)) return null;
  const how = found.map((i) => JSON.stringify({ ...sides[i].settings, weights: "" }));
  return how[0] === how[1] ? found : null;
}

/** Says how far a world has been. */
const upTo = (name, most) => `${name} was ${most > FAR ? "" : "up to "}${percentText(most)}`;

/** Returns a sentence where all worlds left the truth, whose distances (%) of the last seconds `series` lists; or none. */
function parted(series) {
  const recent = series.map((list) => list.slice(-RECENT));
  const have = recent.length > 0 && recent.every((list) => list.length >= ENOUGH && Math.max(...list) > APART);
  return have ? `Motions have parted: lately all were over ${APART} % off, and which is nearer is chance.` : "";
}

/**
 * Returns a sentence on worlds, whose distances (%) of the last seconds `series` lists; or none. It holds for all of these,
 * so that none that is shown beside it denies it. `masses` has those of their particles, and `endMass` is that of the
 * slider, if there is one, which `canMove` where it is no recording.
 */
export function verdict(sides, series, { least, most, end }, endMass, canMove) {
  if (sides[0]?.name === "truth") return parted(series.slice(1));
  const found = compared(sides), both = found?.map((i) => series[i]?.slice(-RECENT));
  if (!both || !both.every((list) => list?.length >= ENOUGH)) return "";
  const [m, e] = both.map((list) => Math.max(...list)), far = Math.max(m, e);
  if (!Number.isFinite(far)) return "One of them flew apart.";
  const heavier = endMass !== null && canMove ? " Make the end heavier." : "";
  const last = endMass ?? end, apart = Math.max(...both[0].map((value, k) => Math.abs(value - both[1][k])));
  if (areAlike(Math.min(least, last), Math.max(most, last)))
    return apart <= Math.max(ALIKE * far, 0.01) ? "All masses are alike: weights make no difference." + heavier
      : "All masses are alike, but small differences have grown.";
  if (far < NEAR) return "Both move as the reference does." + heavier;
  const [byMass, equal] = found.map((i) => sides[i].name);
  if (m < CLOSE && e > MUCH * m) return `${starting(byMass)} stays near the reference. ${starting(upTo(equal, e))}.`;
  if (apart <= ALIKE * far) return "Both are as far from the reference: weights hardly matter here.";
  if (Math.min(m, e) > APART) return `Lately both were over ${APART} % off: differences grow by themselves.`;
  return `Lately ${upTo(byMass, m)}, ${upTo(equal, e).replace(" was", "")}.`;
}
