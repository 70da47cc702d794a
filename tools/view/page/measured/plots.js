// Small plots of what was measured in the last seconds.
import { sideText, theme } from "../colours.js";
import { short } from "./tables.js";

const SAMPLES = 600;

export class Plot {
  /**
   * `scale` is "log" or "linear"; `line` is a value with a dashed line and its text. A linear scale spans `least`, and a
   * logarithmic one reaches it, so that rounding is not drawn as if it mattered.
   */
  constructor(canvas, { scale = "linear", unit, line = null, floor = 0, least = 0, text }) {
    Object.assign(this, { canvas, scale, unit, line, floor, least, text });
    this.clear();
  }

  clear() {
    this.series = [];
  }

  add(values) {
    values.forEach((value, i) => {
      this.series[i] ??= [];
      this.series[i].push(value);
      if (this.series[i].length > SAMPLES) this.series[i].shift();
    });
    this.series.length = values.length;
  }

  range() {
    let low = Infinity, high = -Infinity;
    for (const one of this.series)
      for (const value of one) {
        if (!Number.isFinite(value)) continue;
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
    if (this.line) high = Math.max(high, this.line.value * 1.15);
    if (!(high > -Infinity)) return [0, 1];
    if (this.scale === "log") return [Math.log10(Math.max(low, this.floor)), Math.log10(Math.max(high, this.least)) + 0.1];
    if (this.floor === 0) low = Math.min(low, 0);
    if (high - low < this.least) {
      const middle = (low + high) / 2;
      if (low !== 0) low = middle - this.least / 2;
      high = low + this.least;
    }
    const room = 0.08 * (high - low || Math.abs(high) || 1);
    return [low === 0 ? 0 : low - room, high + room];
  }

  draw() {
    const box = this.canvas.getBoundingClientRect(), ratio = devicePixelRatio || 1;
    if (!box.width) return;
    this.canvas.width = Math.round(box.width * ratio);
    this.canvas.height = Math.round(box.height * ratio);
    const pen = this.canvas.getContext("2d");
    pen.scale(ratio, ratio);
    const { width, height } = box, [low, high] = this.range();
    const y = (value) => {
      const v = this.scale === "log" ? Math.log10(Math.max(value, this.floor)) : value;
      return height - 3 - ((height - 6) * (v - low)) / (high - low || 1);
    };
    pen.font = "10px system-ui, sans-serif";
    pen.fillStyle = pen.strokeStyle = theme().grid;
    if (this.line) {
      const at = y(this.line.value);
      pen.setLineDash([4, 3]);
      pen.beginPath();
      pen.moveTo(0, at);
      pen.lineTo(width, at);
      pen.stroke();
      pen.setLineDash([]);
      pen.fillText(this.line.text, 4, at + 12 < height ? at + 11 : at - 3); // below it, unless the plot ends there
    }
    this.series.forEach((one, i) => {
      pen.strokeStyle = sideText(i, this.series.length);
      pen.lineWidth = 1.5;
      pen.lineJoin = "round";
      pen.beginPath();
      one.forEach((value, k) => {
        const x = width - ((one.length - 1 - k) * width) / (SAMPLES - 1);
        if (k === 0) pen.moveTo(x, y(value));
        else pen.lineTo(x, y(value));
      });
      pen.stroke();
    });
    const top = this.scale === "log" ? 10 ** high : high;
    const word = this.text(top);
    pen.textAlign = "right";
    pen.fillStyle = theme().back;
    pen.fillRect(width - 6 - pen.measureText(word).width, 0, 6 + pen.measureText(word).width, 13);
    pen.fillStyle = theme().grid;
    pen.fillText(word, width - 3, 10);
    this.canvas.setAttribute("aria-label",
      this.unit + ": " + this.series.map((one) => this.text(one.at(-1) ?? 0)).join(", "));
  }
}

const ENERGY = 1e-6; // of all energy: less than that is rounding
/** Returns the plots of a page. `byId` finds their canvases. */
export const makePlots = (byId) => ({
  distance: new Plot(byId("plot-distance"), { least: 0.01, unit: "distance in percent", text: (v) => short(v, 2) + " %" }),
  strain: new Plot(byId("plot-strain"), { scale: "log", floor: 1e-10, least: 1e-6, unit: "largest strain", text: (v) => short(100 * v, 1) + " %" }),
  energy: new Plot(byId("plot-energy"), { floor: -1, unit: "change of energy in joules", text: (v) => short(v) + " J" }),
  time: new Plot(byId("plot-time"), { unit: "time of a step in milliseconds", text: (v) => short(v, 2) + " ms",
                                      line: { value: 16.7, text: "16.7 ms" } }),
});

/** Lets changes of energy be seen from the share of all of it on that is no rounding. */
export function scaleEnergy(plot, { sides }) {
  plot.least = ENERGY * Math.max(...sides.map((side) => side.kinetic + Math.abs(side.potential) + side.elastic));
}
