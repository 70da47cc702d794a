// Names worlds that are shown side by side, each within its own view and beside the bars.
import { sideText } from "../colours.js";

const GAP = 6, LINE = 32, LEAST = 36; // pixels
const boxOf = (id) => document.getElementById(id).getBoundingClientRect();

/** Returns the lowest place in the view that no bar covers. */
function floorOf(view) {
  const bars = ["transport", "winch", "time"].map(boxOf).filter(({ height }) => height > 0);
  return Math.min(view.bottom, ...bars.map(({ top }) => top));
}

/** Returns where the name of a view may be: below in it, or above where views lie below each other. */
function roomOf(port, floor, scale, isStacked) {
  const left = port.x / scale, right = left + port.width / scale - GAP, tools = boxOf("tools");
  const top = isStacked ? port.y / scale + GAP : floor - LINE;
  const isBeside = top < tools.bottom && top + LINE > tools.top;
  return { left: Math.max(left, isBeside ? tools.right : 0) + GAP, right, top };
}

/** Shows the names of worlds. One that has no room is left out; the legend has it, too. */
export function showTitles(place, painter, sides) {
  const ports = painter.viewports(), count = ports.length > 1 ? ports.length : 0;
  if (place.children.length !== count)
    place.replaceChildren(...Array.from({ length: count }, () => document.createElement("p")));
  if (!count) return;
  const view = painter.canvas.getBoundingClientRect(), scale = painter.canvas.width / view.width;
  const isStacked = ports[1].y > 0, floor = floorOf(view);
  ports.forEach((port, k) => {
    const title = place.children[k], number = port.shown[0], name = sides[number]?.name ?? "";
    const { left, right, top } = roomOf(port, floor, scale, isStacked);
    title.hidden = right - left < LEAST || top + LINE > floor;
    title.className = isStacked ? "stacked" : "";
    Object.assign(title.style, { left: left + "px", width: right - left + "px", top: top + "px", color: sideText(number, sides.length) });
    if (title.textContent !== name) {
      const span = document.createElement("span");
      span.textContent = name;
      title.replaceChildren(span);
    }
  });
}
