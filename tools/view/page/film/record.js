// Keeps what the page was shown, so that it can be saved as a page of its own.

const MOST_BYTES = 48e6, MOST_FRAMES = 1800;

export class Recording {
  constructor() {
    this.texts = {};
    this.frames = [];
    this.bytes = 0;
  }

  /** Keeps the latest message of a kind. A new scene begins a new recording. */
  text(message) {
    if (message.kind === "scene") this.clear();
    if (["menu", "scene", "sides"].includes(message.kind)) this.texts[message.kind] = message;
  }

  clear() {
    this.frames = [];
    this.bytes = 0;
  }

  /** Keeps a frame that moved on. The first ones are dropped where all would be too much. */
  frame(bytes, number) {
    if (number === this.latest && this.frames.length) return;
    this.latest = number;
    this.frames.push(bytes);
    this.bytes += bytes.byteLength;
    while (this.frames.length > MOST_FRAMES || this.bytes > MOST_BYTES) this.bytes -= this.frames.shift().byteLength;
  }
}
