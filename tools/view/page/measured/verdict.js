// Says in words what a comparison of weights shows.

const RECENT = 180; // frames
const NEAR = 1, CLOSE = 3, APART = 10; // percent
const MUCH = 2; // times as far
export const ALIKE = 0.1; // of the larger one

const rms = (list) => Math.sqrt(list.reduce((sum, value) => sum + value * value, 0) / list.length);

/** Spells how far a world is from the first, in percent. */
export function percentText(percent) {
  if (!Number.isFinite(percent) || percent > 1e4) return "far off";
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

/**
 * Returns a sentence on worlds, whose distances (%) of the last seconds `series` lists; or none. `masses` has those of
 * their particles, and `endMass` is that of the slider, if there is one.
 */
export function verdict(sides, series, { least, most, end }, endMass) {
  const both = compared(sides)?.map((i) => series[i]?.slice(-RECENT));
  if (!both || !both.every((list) => list?.length >= 60)) return "";
  const [m, e] = both.map(rms), far = Math.max(m, e);
  if (!Number.isFinite(far)) return "One of them flew apart.";
  const heavier = endMass !== null ? " Make the end heavier." : "";
  const last = endMass ?? end;
  if (Math.max(most, last) <= (1 + ALIKE) * Math.min(least, last)) return "All masses are alike, so that weights do not matter." + heavier;
  if (far < NEAR) return "Both move as the reference does." + heavier;
  if (e > MUCH * m)
    return m < CLOSE ? "By mass moves as the reference does. Equal does not."
      : `By mass is ${Math.round(e / m)} times nearer to the reference than equal, in the mean of 3 s.`;
  if (far > APART && Math.min(m, e) > APART / MUCH)
    return "Both have left the reference: differences grow as worlds move on. Reset begins again.";
  if (Math.abs(m - e) < ALIKE * far) return "Both are as far from the reference: weights hardly matter here.";
  return (m < e ? "By mass" : "Here equal") + " is nearer to the reference.";
}
