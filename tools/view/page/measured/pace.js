// Says when worlds fall behind real time or keep the page waiting, and knows when the page itself stood still.
import { short } from "./tables.js";

const LONG = 1000; // ms, of waiting or of slowness that is worth a word
const SLOW = 0.9; // of the speed that was asked for
const GAPS = 4; // times as long as usual is a gap in which the page did not run
const RECENT = 5000; // ms, in which frames from before a gap still come
const STAYS = 3000; // ms, so that a number can be read
const FRAME = 1000 / 60; // ms
// What answers requests that may take long.
const ANSWERS = { step: "frame", set: "sides", reset: "scene", defaults: "scene", load: "scene", compare: "scene", add: "scene", drop: "scene" };
const WHY = "Steps take longer than the time that they simulate. Fewer substeps, sweeps, worlds or particles are faster.";

export class Pace {
  constructor(place) {
    Object.assign(this, { place, isOpen: false, awaits: new Set(), number: -1, waited: 0, slow: 0, usual: FRAME, last: 0, woke: -Infinity, said: 0, kind: "" });
  }

  /** The connection to worlds opens or closes. Nothing that was asked for before is waited for. */
  connect(isOpen) {
    this.isOpen = isOpen;
    this.awaits.clear();
  }

  /** A request is on its way. */
  ask({ do: verb }) {
    if (!ANSWERS[verb]) return;
    if (!this.awaits.size) this.waited = 0;
    this.awaits.add(ANSWERS[verb]);
  }

  /** A text came. What was refused needs no other answer. */
  hear({ kind, refused }) {
    if (refused) this.awaits.clear();
    this.awaits.delete(kind);
  }

  /** A frame of that number came. */
  take(number) {
    if (number !== this.number) this.awaits.delete("frame");
    this.number = number;
    this.waited = 0;
  }

  /** Returns whether the page did not run for a while until just now, as where its tab slept. */
  hasSlept(now) {
    return now - this.woke < RECENT || this.isGap(now - this.last);
  }

  isGap(gap) {
    return this.last > 0 && gap > Math.max(LONG, GAPS * this.usual);
  }

  /** A picture is drawn of a frame, if there is one. `speed` is what was asked for; none of a recording. */
  tick(now, frame, speed) {
    const gap = this.last ? now - this.last : FRAME;
    const hasStood = this.isGap(gap);
    if (hasStood) this.woke = now;
    this.usual += 0.1 * (Math.min(gap, RECENT) - this.usual);
    this.last = now;
    const passed = hasStood ? 0 : gap; // a page that slept did not wait
    this.waited += passed;
    const isSlow = frame?.playing && frame.reached > 0 && frame.reached < SLOW * speed;
    this.slow = isSlow ? this.slow + passed : 0;
    const waits = this.isOpen && (!frame || frame.playing || this.awaits.size) && this.waited > LONG;
    this.say(now, waits ? "computing" : this.slow > LONG ? "slow" : "", frame, speed);
  }

  say(now, kind, frame, speed) {
    if (kind === this.kind && (kind !== "slow" || now - this.said < STAYS)) return;
    Object.assign(this, { kind, said: now });
    this.place.className = kind;
    this.place.title = kind === "slow" ? WHY : "";
    this.place.textContent = { computing: "Computing …", slow: kind === "slow" && slowText(frame, speed) }[kind] ?? "";
  }
}

function slowText({ reached, stepUs, frameUs }, speed) {
  const isStep = (stepUs + frameUs) / 1000 > 0.7 * FRAME / speed; // else something else than plumb keeps the computer busy
  return `${short(reached, 2)} × real time${isStep ? `: a step takes ${short(stepUs / 1000, 2)} ms` : ""}`;
}
