// What the words of the controls mean, for who has not read about methods.

/** Of each control, plot and counter: what it does or says. */
export const TERMS = {
  scene: "What is simulated.",
  parameters: "The scene as name:parameter=value, with commas between parameters.",
  compare: "Which worlds run side by side.",
  "end mass": "Mass of the last particle. Worlds start again once it is let go.",
  gravity: "How strongly everything is pulled down.",
  drag: "How quickly air slows everything down.",
  defaults: "From the start again, with the settings that scene and comparison had first.",
  distance: "How far particles are from those of the first world, over the size of the scene.",
  strain: "By which share the worst rod is longer or shorter than it should be.",
  energy: "Of motion, height and stretch together, since the start. Only drag, blows and hands should change it.",
  time: "How long the computer takes for a step. Above the dashed line worlds are slower than in reality.",
  "add or drop a world": "One more world with these settings, or without this one. All worlds start again, so that they can be compared.",
  method: "How rods keep their length.",
  gradient: "Along which direction the ends of a rod are corrected.",
  weights: "How the two ends of a rod share its correction.",
  substeps: "Parts that each 1/60 s is computed in. More are more exact, and take longer.",
  sweeps: "How often relaxation goes over all rods in a substep. More keep lengths better, and take longer.",
  tolerance: "Sweeps stop where no rod is off by more than this share of its length.",
  accuracy: "By how much the error may grow in a second, over the size of the scene. Substeps are chosen to keep it.",
  colours: "What the colours of rods tell.",
  "over each other": "Worlds are drawn in one place, or else side by side.",
  trails: "The way that the last particle took is drawn behind it.",
  "awake islands": "Islands are what hangs together. Those that move are awake.",
  "asleep, skipped": "Islands that rest. They are not computed.",
  "sweeps of blocks": "How often a sweep went over a block, which is a group of rods, in all.",
  "Newton steps": "Rounds in which method direct finds where all rods fit at once.",
  "within tolerance": "Blocks whose rods fitted already, and that no sweep went over.",
  "not solved or accurate": "Substeps that ended with rods not quite fitted, or with a larger error than asked for.",
};

/** Of each choice of a control: what it stands for. */
export const CHOICES = {
  compare: {
    "mass against equal": "a heavy end shows why masses matter", "relax against direct": "rod by rod, or all at once",
    gradients: "three directions of a correction", "error against truth": "how wrong each world is", "one world": "nothing beside it",
  },
  method: {
    auto: "relax or direct, as suits", relax: "one rod after the other, repeatedly", direct: "all rods at once", springs: "stiff springs as rods",
    multipliers: "by the forces that hold rods", featherstone: "by the angles of links",
  },
  gradient: {
    auto: "as suits the method", new: "where rods lie after the substep; damps", old: "where they lay before; needs short substeps",
    mid: "halfway between; keeps energy",
  },
  weights: { mass: "the lighter end moves more", equal: "both ends move as far" },
  colours: {
    world: "which world it is", strain: "longer or shorter than it should be", tension: "how hard a rod pulls or pushes", sleep: "what rests",
    island: "what hangs together", color: "rods that are corrected at once", lane: "places among those",
  },
};

/** Returns the name of a choice with what it stands for. */
export function choiceText(term, value, name = value) {
  const about = CHOICES[term]?.[value];
  return about ? `${name}: ${about}` : name;
}
