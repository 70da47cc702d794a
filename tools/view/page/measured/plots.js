// Small plots of what was measured in the last seconds.
import { sideText, theme } from "../colours.js";

const SAMPLES = 600;

export class Plot {
  /** `scale` is "log" or "linear"; `line` is a value with a dashed line and its text. */
  constructor(canvas, { scale = "linear", unit, line = null, floor = 0, text }) {
    Object.assign(this, { canvas, scale, unit, line, floor, text });
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
    if (this.scale === "log") return [Math.log10(Math.max(low, this.floor)), Math.log10(Math.max(high, 10 * this.floor)) + 0.1];
    if (this.floor === 0) low = Math.min(low, 0);
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
      pen.setLineDash([4, 3]);
      pen.beginPath();
      pen.moveTo(0, y(this.line.value));
      pen.lineTo(width, y(this.line.value));
      pen.stroke();
      pen.setLineDash([]);
      pen.fillText(this.line.text, 4, y(this.line.value) + 11);
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
