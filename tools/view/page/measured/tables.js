// Tables of the last step: what it did, and what took how long.

/** Spells a number with few digits. */
export function short(value, digits = 3) {
  if (value === 0) return "0";
  const isUsual = Math.abs(value) >= 1e-3 && Math.abs(value) < 1e5;
  return isUsual ? String(Number(value.toPrecision(digits))) : value.toExponential(1);
}

const COUNTERS = [["awake islands", (s) => `${s.awake} / ${s.islands}`], ["asleep, skipped", (s) => s.islands - s.awake],
                  ["substeps", (s) => s.substeps], ["sweeps of blocks", (s) => s.sweeps], ["Newton steps", (s) => s.newton],
                  ["within tolerance", (s) => s.skipped], ["not solved or accurate", (s) => s.troubles]];

const row = (title, cells) => `<tr data-term="${title}"><th scope="row">${title}</th>${cells.map((cell) => `<td>${cell}</td>`).join("")}</tr>`;

/** Returns rows of what the step did in each world. */
export function counterRows({ sides }) {
  return COUNTERS.map(([title, of]) => row(title, sides.map(of))).join("");
}

/** Returns rows of the time of each stage, beside what a frame may take. */
export function stageRows({ sides, stepUs, frameUs }, names) {
  const ms = (us) => (us / 1000).toFixed(2);
  const all = stepUs + frameUs;
  return names.map((name, i) => row(name, sides.map((side) => ms(side.stagesUs[i])))).join("")
    + row("step", sides.map((side) => ms(side.stepUs))) + row("all worlds", [ms(stepUs)]) + row("to the page", [ms(frameUs)])
    + `<tr class="${all > 1e6 / 60 ? "late" : ""}"><th scope="row">of 16.67 ms</th><td>${short(0.006 * all, 2)} %</td></tr>`;
}
