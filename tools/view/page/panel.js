// The controls: what they show and what they ask for.
import { diverging, islandColour, mixed, rgb, sideColour, sideText } from "./colours.js";
import { NOWHERE, requests } from "./messages.js";
import { isSmall } from "./measured/why.js";
import { explain, mean } from "./words/explain.js";
import { choiceText } from "./words/terms.js";

const byId = (id) => document.getElementById(id);
const decades = (from, to, steps) => {
  const out = [];
  for (let e = from; e < to; ++e) for (const s of steps) out.push(Number((s * 10 ** e).toPrecision(3)));
  return [...out, 10 ** to];
};
const evenly = (from, to, step) => Array.from({ length: Math.round((to - from) / step) + 1 }, (_, i) => Number((from + i * step).toFixed(6)));

const COMMON = [
  { name: "end_mass", label: "End mass", unit: " kg", restarts: true,
    values: decades(-1, 3, [1, 1.5, 2, 3, 5, 7]) },
  { name: "gravity", label: "Gravity", unit: " m/s²", values: evenly(0, 20, 0.01).filter((g) => g === 9.81 || (g * 2) % 1 === 0) },
  { name: "drag", label: "Drag", unit: " /s", values: [0, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 1, 1.5, 2, 3, 5] },
];
const OWN = [
  { name: "substeps", label: "Substeps", unit: "", values: [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 128] },
  { name: "sweeps", label: "Sweeps", unit: "", values: [1, 2, 3, 4, 5, 7, 10, 15, 20, 30, 50, 100, 200, 500, 1000] },
  { name: "tolerance", label: "Tolerance", unit: "", values: ["off", 0.1, 0.01, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8] },
  { name: "accuracy", label: "Accuracy", unit: "", values: ["off", 0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 1e-4, 1e-5, 1e-6] },
];
const WORDS = [
  { name: "method", label: "Method" },
  { name: "gradient", label: "Gradient", words: ["auto", "new", "old", "mid"] },
  { name: "weights", label: "Weights", words: ["mass", "equal"] },
];

const OTHERS = "The first world, pale and wide, is the reference. Each is thinner than the one before, so that all are seen in one place.";

function nearest(values, value) {
  if (value === "off") return Math.max(0, values.indexOf("off"));
  let best = 0;
  values.forEach((v, i) => {
    if (typeof v === "number" && !(Math.abs(v - value) >= Math.abs(values[best] - value))) best = i;
  });
  return best;
}

function slider({ name, label, unit, values }, ask) {
  const row = document.createElement("label");
  row.className = "row slider";
  row.innerHTML = `<span>${label}</span><input type="range" min="0" max="${values.length - 1}" step="1"><output></output>`;
  const [input, output] = [row.querySelector("input"), row.querySelector("output")];
  input.id = "set-" + name;
  mean(row, label.toLowerCase());
  const show = (value) => {
    output.textContent = value === "off" ? "off" : Number(Number(value).toPrecision(4)) + unit;
    input.setAttribute("aria-valuetext", output.textContent);
  };
  input.addEventListener("input", () => {
    show(values[input.value]);
    ask(name, values[input.value]);
  });
  return { row, input, set: (value) => {
    if (document.activeElement === input && input.matches(":active")) return;
    input.value = nearest(values, value === "off" ? value : Number(value));
    show(value);
  } };
}

function chooser({ name, label, words }, ask) {
  const row = document.createElement("label");
  row.className = "row";
  row.innerHTML = `<span>${label}</span><select></select>`;
  const select = row.querySelector("select");
  select.id = "set-" + name;
  select.append(...words.map((word) => new Option(choiceText(name, word), word)));
  mean(row, name);
  select.addEventListener("change", () => ask(name, select.value));
  return { row, input: select, set: (value) => { select.value = value; } };
}

export class Panel {
  constructor(send) {
    this.send = send;
    this.side = null;
    this.common = COMMON.map((each) => ({ ...each, ...slider(each, (name, value) => send(requests.set(name, value))) }));
    // A mass that changes in mid-swing is a blow. Worlds are compared from the start.
    for (const { restarts, input } of this.common) if (restarts) input.addEventListener("change", () => send(requests.reset()));
    byId("common").append(...this.common.map(({ row }) => row));
    byId("load").addEventListener("submit", (event) => {
      event.preventDefault();
      send(requests.load(byId("spec").value.trim()));
    });
    byId("generator").addEventListener("change", () => {
      byId("spec").value = byId("generator").value;
      send(requests.load(byId("spec").value));
    });
    byId("defaults").addEventListener("click", () => send(requests.defaults()));
    byId("compare").addEventListener("change", () => send(requests.compare(byId("compare").value)));
    byId("fold").addEventListener("click", () => {
      const opens = byId("fold").getAttribute("aria-expanded") !== "true";
      byId("fold").setAttribute("aria-expanded", opens);
    });
    for (const choice of byId("colour").options) choice.text = choiceText("colours", choice.value, choice.text);
    explain(byId("panel"), byId("explained"), byId("words"));
    if (isSmall.matches) byId("fold").setAttribute("aria-expanded", "false");
  }

  setMenu({ scenes, comparisons, methods, stages }) {
    this.send(requests.speed(byId("speed").value)); // a page before this one may have left another
    this.stages = stages;
    this.methods = methods;
    byId("generator").replaceChildren(new Option("choose a scene …", ""),
      ...scenes.map(({ name, about }) => new Option(`${name}: ${about}`, name)));
    byId("compare").replaceChildren(new Option("own choice", "", false, false), ...comparisons.map((name) => new Option(choiceText("compare", name), name)));
    const ask = (name, value) => this.send(requests.set(name, value, this.side));
    WORDS[0].words = methods.map(({ name }) => name);
    this.own = [...WORDS.map((each) => ({ ...each, ...chooser(each, ask) })), ...OWN.map((each) => ({ ...each, ...slider(each, ask) }))];
    byId("settings").replaceChildren(...this.own.map(({ row }) => row));
  }

  setScene({ name }) {
    byId("spec").value = byId("spec").title = name;
    this.showGenerator(name);
  }

  showGenerator(name) {
    const generator = [...byId("generator").options].find(({ value }) => value === name.split(":")[0]);
    byId("generator").value = generator ? generator.value : "";
  }

  setSides(message) {
    this.sides = message.sides;
    this.side = Math.min(this.side ?? 1, this.sides.length - 1); // the reference has the fewest settings
    for (const each of this.common) {
      each.row.hidden = message[each.name] === null;
      if (message[each.name] !== null) each.set(message[each.name]);
    }
    byId("compare").value = message.comparison;
    byId("about").textContent = message.about || (message.sides.length > 1 ? OTHERS : "");
    byId("intro").hidden = !byId("about").textContent;
    byId("hint").textContent = message.hint;
    byId("distance").textContent = message.sides[0].name === "truth" ? "error, % of size" : "distance, % of size";
    this.showTabs();
  }

  showTabs() {
    const tabs = this.sides.map(({ name }, i) => {
      const tab = document.createElement("button");
      tab.textContent = name;
      tab.setAttribute("role", "tab");
      tab.setAttribute("aria-selected", i === this.side);
      tab.style.setProperty("--c", sideText(i, this.sides.length));
      tab.addEventListener("click", () => {
        this.side = i;
        this.showTabs();
      });
      return tab;
    });
    const count = this.sides.length;
    const button = (text, title, off, act) => {
      const out = document.createElement("button");
      Object.assign(out, { textContent: text, title, disabled: off });
      mean(out, "add or drop a world");
      out.addEventListener("click", act);
      return out;
    };
    const more = document.createElement("span");
    const [isFull, isLast] = [count > 3, count < 2];
    more.append(
      button("+", isFull ? "There are four worlds, and no more fit" : "One more world with these settings; all start again", isFull, () => {
        this.send(requests.addSide(this.side));
        this.side = count; // the new one, once it is there
      }),
      button("−", isLast ? "The last world stays" : "Take this world away; all start again", isLast,
        () => this.send(requests.dropSide(this.side))), "starts all again");
    byId("tabs").replaceChildren(...tabs, more);
    const { settings } = this.sides[this.side];
    const reads = this.methods.find(({ name }) => name === settings.method)?.reads ?? [];
    for (const each of this.own) {
      each.set(settings[each.name]);
      const isRead = ["method", "substeps"].includes(each.name) || reads.includes(each.name);
      each.input.disabled = !isRead;
      each.row.classList.toggle("off", !isRead);
    }
  }
}

const css = (colour) => `rgb(${colour.map((c) => Math.round(255 * c)).join()})`;
const swatch = (colour, text) => `<i style="background: ${css(colour)}"></i>${text} `;

/** Says what colours mean, with units. */
export function showKey(place, { colour, model }, { sides }) {
  place.hidden = colour === "world";
  const largest = Math.max(...sides.map((side) => side.largest));
  const own = sideColour(0, sides.length), back = rgb("back");
  const ends = { strain: (v) => (100 * v).toPrecision(2) + " %", tension: (v) => v.toPrecision(3) + " N" }[colour];
  const some = (list, title, rest) => {
    const count = list.reduce((most, each) => (each === NOWHERE ? most : Math.max(most, each + 1)), 0);
    const shown = Array.from({ length: Math.min(count, 8) }, (_, i) => swatch(islandColour(i), i + 1)).join("");
    return `${title} (${count}): ${shown}${count > 8 ? "… " : ""}${swatch(mixed(own, back, 0.7), rest)}`;
  };
  const texts = {
    sleep: () => swatch(diverging(0.8), "awake") + swatch(mixed(rgb("ink"), back, 0.75), "asleep"),
    island: () => some(model.scene.islands, "island", "dim: asleep"),
    color: () => some(model.scene.colors, "colour of the graph", "none"),
    lane: () => some(model.scene.lanes, "lane", "none"),
  };
  const bar = Array.from({ length: 9 }, (_, i) => css(diverging(i / 4 - 1))).join();
  const words = colour === "tension" ? ["pushes", "pulls"] : ["short", "long"];
  const html = ends ? `${words[0]} −${ends(largest)} <em style="background: linear-gradient(90deg, ${bar})"></em> ${ends(largest)} ${words[1]}`
    : texts[colour]?.() ?? "";
  if (place.innerHTML !== html) place.innerHTML = html;
}
