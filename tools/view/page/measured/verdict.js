// Says in words what a comparison of weights has shown so far.

const MUCH = 2; // times as far
const AT_ALL = 0.5; // percent

const mean = (list) => Math.sqrt(list.reduce((sum, value) => sum + value * value, 0) / list.length);

/** Spells how far a world is from the first, in percent. */
export function percentText(percent) {
  if (!Number.isFinite(percent) || percent > 1e4) return "far off";
  return `${percent < 1e-3 ? 0 : Number(percent.toPrecision(2))} % off`;
}

/** Returns a sentence on worlds of these names, whose distances (%) of the last seconds `series` lists; or none. */
export function verdict(names, series) {
  const [byMass, equal] = ["by mass", "equal"].map((name) => series[names.indexOf(name)]);
  if (!byMass || !equal || byMass.length < 60) return "";
  const [m, e] = [mean(byMass), mean(equal)];
  if (!(Number.isFinite(m) && Number.isFinite(e))) return "One of them flew apart.";
  if (m < AT_ALL && e < AT_ALL) return "Both move as the reference does. Make the end heavier.";
  if (e > MUCH * m) return "By mass moves as the reference does. Equal does not.";
  if (m > MUCH * e) return "Here equal is nearer. By mass needs more sweeps or substeps.";
  return "Neither moves as the reference does. More sweeps or substeps bring them closer.";
}
