// Decodes a frame by the page's own messages.js and prints its numbers, then requests as the page spells them.
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";

const { decodeFrame, hashText, requests } = await import(pathToFileURL(process.argv[2]));
const bytes = readFileSync(process.argv[3]);
const frame = decodeFrame(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));
for (const side of frame.sides) {
  side.hash = hashText(side.hash);
  for (const name of ["positions", "gone", "flags"]) side[name] = [...side[name]];
  side.values = [...side.values].map((value) => (Number.isNaN(value) ? "none" : value));
}
let refused = false;
try {
  decodeFrame(new ArrayBuffer(40));
} catch {
  refused = true;
}
const asked = [requests.pull(5, [1, 2.5, -3]), requests.set("substeps", 8, 1), requests.set("gravity", 1.62),
               requests.throwBall([0, 1, 0], [3, 0, 0], 0.1), requests.reel("rod", 2, -0.25), requests.cut(7)];
console.log(JSON.stringify({ frame, refused, asked }));
