// Says in words what a comparison of weights shows.

const RECENT = 180; // frames
const NEAR = 1, CLOSE = 3, APART = 10; // percent
const MUCH = 2, FAR_MORE = 5; // times as far
const ALIKE = 0.1; // of the larger one

const starting = (words) => words[0].toUpperCase() + words.slice(1);
const rms = (list) => Math.sqrt(list.reduce((sum, value) => sum + value * value, 0) / list.length);

/** Returns whether masses from one to another are so alike that weights make no difference. */
export const areAlike = (least, most) => most <= (1 + ALIKE) * least;

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
 * their particles, and `endMass` is that of the slider, if there is one, which `canMove` where it is no recording.
 */
export function verdict(sides, series, { least, most, end }, endMass, canMove) {
  const found = compared(sides), both = found?.map((i) => series[i]?.slice(-RECENT));
  if (!both || !both.every((list) => list?.length >= 60)) return "";
  const [m, e] = both.map(rms), far = Math.max(m, e);
  if (!Number.isFinite(far)) return "One of them flew apart.";
  const heavier = endMass !== null && canMove ? " Make the end heavier." : "";
  const last = endMass ?? end;
  if (areAlike(Math.min(least, last), Math.max(most, last))) return "All masses are alike: weights make no difference." + heavier;
  if (far < NEAR) return "Both move as the reference does." + heavier;
  const [byMass, equal] = found.map((i) => sides[i].name);
  if (e > MUCH * m)
    return m < CLOSE ? `${starting(byMass)} moves as the reference does. ${starting(equal)} does not.`
      : `${starting(byMass)} is ${e > FAR_MORE * m ? "much " : ""}nearer to the reference than ${equal}.`;
  if (far > APART && Math.min(m, e) > APART / MUCH)
    return "Both have left the reference: differences grow as worlds move on. Reset begins again.";
  if (Math.abs(m - e) < ALIKE * far) return "Both are as far from the reference: weights hardly matter here.";
  return starting(m < e ? byMass : "here " + equal) + " is nearer to the reference.";
}
