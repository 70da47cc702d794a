// Draws one correction of the last rod, shared by mass and equally: why weights matter, in a picture.
import { sideText } from "../colours.js";
import { areAlike, compared } from "./verdict.js";

const WIDTH = 380, HEIGHT = 78, ROWS = [19, 58]; // pixels
const LIGHT = 76, HEAVY = 192, SAYS = 266; // where discs and words beside them are
const LINE = 14; // between two lines of words
const EXCESS = 76; // what the rod is too long by, which arrows share
const HEAD = 6; // of an arrow

const radius = (mass) => Math.min(17, Math.max(4, 7.2 + 3.2 * Math.log10(mass)));
const kilograms = (mass) => `${Number(mass.toPrecision(3))} kg`;
const percent = (share) => `${Number((100 * share).toPrecision(share < 0.1 ? 1 : share > 0.99 ? 3 : 2))} %`;
const times = (ratio) => (ratio < 10 ? Number(ratio.toPrecision(2)) : Math.round(ratio));

/** Draws an arrow from `x` on, which goes `way` pixels to the right, or to the left if that is negative. */
function arrow(x, y, way) {
  const size = Math.min(HEAD, Math.abs(way)) * Math.sign(way), tip = x + way;
  return `<path d="M${x} ${y}H${tip - size}" stroke="var(--c)" stroke-width="3.5"/>`
    + `<path d="M${tip} ${y}l${-size} ${-Math.abs(size) * 0.8}v${Math.abs(size) * 1.6}z" fill="var(--c)"/>`;
}

/** Draws a row: discs of these masses, and arrows by the share of the first. */
function row({ y, name, colour, masses, share, says }) {
  const [r, s] = masses.map(radius), left = LIGHT + r, right = HEAVY - s;
  const text = (x, down, anchor, word, more = "") => `<text x="${x}" y="${y + down}" text-anchor="${anchor}" ${more}>${word}</text>`;
  return `<g style="--c: ${colour}">`
    + text(0, -3, "start", name, 'class="name"') // a line above the mass, which may be long
    + `<path d="M${LIGHT} ${y}H${HEAVY}" stroke="currentColor" stroke-width="1.5"/>`
    + `<circle cx="${LIGHT}" cy="${y}" r="${r}"/><circle cx="${HEAVY}" cy="${y}" r="${s}"/>`
    + arrow(left, y, EXCESS * share) + arrow(right, y, -EXCESS * (1 - share))
    + text(LIGHT - r - 4, LINE - 3, "end", kilograms(masses[0])) + text(HEAVY + s + 4, 4, "start", kilograms(masses[1]))
    + text(left + 1, -6, "start", percent(share), 'class="share"') + text(right - 1, -6, "end", percent(1 - share), 'class="share"')
    + says.map((line, i) => text(SAYS, LINE * i - 3, "start", line, 'class="says"')).join("") + "</g>";
}

/**
 * Shows the picture where worlds by mass and equal are compared and the masses at the last rod differ. `masses` are those
 * that a model weighs, and `endMass` is that of the slider.
 */
export function showWhy(place, sides, masses, endMass) {
  const both = compared(sides), { next } = masses;
  place.hidden = !both || endMass === null || !next || areAlike(Math.min(next, endMass), Math.max(next, endMass));
  if (place.hidden) return;
  const share = endMass / (next + endMass);
  const [light, heavy] = [next, endMass].sort((a, b) => a - b);
  const [few, many] = [light, heavy].map(kilograms), ratio = times(heavy / light);
  const rows = [
    { name: "by mass", share, says: [`${few} goes ${ratio} ×`, `as far as ${many}`] },
    { name: "equal", share: 0.5, says: [`${many} is moved`, `like ${few}`] }];
  const label = `By mass, ${kilograms(next)} takes ${percent(share)} of the way and ${kilograms(endMass)} takes ${percent(1 - share)}. `
    + `Equal gives each 50 %: ${many} is moved like ${few}.`;
  const drawn = rows.map((each, i) =>
    row({ ...each, y: ROWS[i], colour: sideText(both[i], sides.length), masses: [next, endMass] })).join("");
  place.querySelector("svg").outerHTML =
    `<svg viewBox="0 0 ${WIDTH} ${HEIGHT}" width="${WIDTH}" height="${HEIGHT}" role="img" aria-label="${label}">${drawn}</svg>`;
}

/** Tells whether the window has no room for all at once. */
export const isSmall = matchMedia("(max-width: 760px), (max-height: 480px)");

/** Opens the picture, or leaves a line of it that opens where it would cover worlds. */
export function foldWhy(place) {
  const fold = () => { place.open = !isSmall.matches; };
  isSmall.addEventListener("change", fold);
  fold();
}
