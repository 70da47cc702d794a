// Puts the page together.
import { Camera } from "./camera.js";
import { onSchemeChange, sideText } from "./colours.js";
import { Painter } from "./draw.js";
import { Recording } from "./film/record.js";
import { pageOf, save } from "./film/save.js";
import { Hands } from "./hands.js";
import { decodeFrame, hashText, requests } from "./messages.js";
import { Panel, showKey } from "./panel.js";
import { Pace } from "./measured/pace.js";
import { makePlots, scaleEnergy } from "./measured/plots.js";
import { connect } from "./socket.js";
import { counterRows, short, stageRows } from "./measured/tables.js";
import { percentText, verdict } from "./measured/verdict.js";
import { foldWhy, showWhy } from "./measured/why.js";
import { note, offerTakeover, unsay } from "./words/note.js";
import { showTitles } from "./words/titles.js";

const byId = (id) => document.getElementById(id);
const isFilm = document.body.classList.contains("film");
const canvas = byId("view"), camera = new Camera();
const PAUSED = "Paused: this moves once worlds play (Space) or step (.). Hold on until then.";
const LOADING = "Loading …";
const MANY_FRAMES = 60; // of which none was taken: more is not a slow page but one that slept
const pace = new Pace(byId("pace"));
const plots = makePlots(byId);
let painter = null, sides = [], frame = null, before = null, arrived = 0, period = 1000 / 60, firstEnergy = null;
let reelRate = 0, lastSides = null;
let isFresh = false, isTold = false, drawn = "", ticks = 0; // whether worlds have news, whether numbers are those of now, what is shown

// What was refused is no longer shown as if it had been taken.
function hear({ text, refused }) {
  note(text, refused);
  if (refused && painter?.model) panel.showGenerator(painter.model.scene.name);
}

const recording = new Recording();
const early = []; // what came before there was anything to draw with
const show = (message) => {
  if (!painter) {
    early.push(message);
    return;
  }
  recording.text(message);
  pace.hear(message);
  ({ menu: () => panel.setMenu(message), scene: () => setScene(message), sides: () => setSides(message),
                        note: () => hear(message), replay: () => saveAs("replay.json", message.text, "application/json") })[message.kind]?.();
};
const tell = connect({
  text: show,
  frame: (bytes) => {
    if (!painter?.model) return;
    const next = decodeFrame(bytes);
    recording.frame(bytes, next.frame);
    pace.take(next.frame);
    take(next);
  },
  state: (state, text, takeOver) => {
    pace.connect(state === "open" && !isFilm);
    if (takeOver) offerTakeover(text, takeOver);
    else note(text, state !== "open", state !== "open");
    // Nobody would hear what is asked for here.
    for (const id of ["panel", "tools", "winch", "transport"]) byId(id).inert = state !== "open";
  },
});
const send = (message) => {
  const request = JSON.parse(message);
  if (request.do === "load") note(LOADING, false, true); // which takes long where a step does
  pace.ask(request);
  tell(message);
};
const panel = new Panel(send);

/** What tools see of the page. */
const page = {
  send,
  sayIfPaused: () => {
    if (frame && !frame.playing) note(PAUSED);
  },
  isFixed: (particle) => (frame?.sides[0].flags[particle] & 2) !== 0,
  choseRod: (rod) => {
    byId("winch").hidden = false;
    winch = { kind: "rod", number: rod };
    byId("reeled").textContent = `rod ${rod}`;
  },
};
let winch = null;

function begin() {
  try {
    painter = new Painter(canvas);
  } catch (error) {
    note(error.message, true, true);
    return;
  }
  page.hands = new Hands(canvas, painter, camera, page);
  if (isFilm) page.hands.tool = "look";
  early.forEach(show);
  requestAnimationFrame(draw);
}

const clearPlots = () => Object.values(plots).forEach((plot) => { plot.clear(); plot.draw(); });

function setScene(scene) {
  unsay(LOADING);
  const more = scene.name === painter.model?.scene.name ? scene.masses.length - painter.model.particles : -1;
  const model = painter.setScene(scene, more > 0); // by a thrown ball
  if (more < 0) camera.frame(model);
  panel.setScene(scene);
  frame = before = firstEnergy = null;
  clearPlots();
  byId("verdict").textContent = byId("clock").textContent = ""; // a step may take long
  winch = scene.reels ? { kind: "reel", number: 0 } : scene.tackles.length ? { kind: "tackle", number: 0 }
    : scene.name.startsWith("winch") ? { kind: "rod", number: 0 } : null;
  byId("winch").hidden = !winch || page.hands.tool !== "reel";
  byId("reeled").textContent = winch ? `${winch.kind} ${winch.number}` : "";
  const thrower = document.querySelector('[data-tool="throw"]');
  thrower.disabled = !scene.has_shapes;
  if (thrower.disabled && page.hands.tool === "throw") setTool("pull");
  thrower.title = scene.has_shapes ? "Click to throw a ball (5)" : "Nothing in this scene has a shape that a ball could hit";
  painter.chosen = -1;
}

function setSides(message) {
  lastSides = message;
  isFresh = true;
  sides = message.sides;
  panel.setSides(message);
  if (message.end_mass !== null) painter.setEndMass(message.end_mass);
  if (painter.model) showWhy(byId("why"), sides, painter.model.masses, message.end_mass);
  byId("legend").replaceChildren(...sides.map(({ name }, i) => {
    const item = document.createElement("li");
    item.style.setProperty("--c", sideText(i, sides.length));
    item.innerHTML = "<i></i><b></b><span></span>";
    item.querySelector("b").textContent = name;
    return item;
  }));
}

function take(next) {
  if (!painter?.model || next.sides[0].positions.length !== 3 * painter.model.particles) return;
  const missed = frame ? next.frame - frame.frame - 1 : 0;
  if (missed < -1 || missed > MANY_FRAMES) painter.clearTrails();
  if (missed < -1) clearPlots(); // a recording begins again
  const now = performance.now();
  if (!isFilm && missed > MANY_FRAMES && pace.hasSlept(now)) note(`This page slept through ${missed} frames. It goes on at the present; plots and recording leave them out.`);
  if (frame && next.frame > frame.frame && missed <= MANY_FRAMES) {
    period = Math.min(400, Math.max(8, now - arrived));
    before = frame;
  } else before = null;
  arrived = now;
  const isNew = !frame || next.frame !== frame.frame;
  frame = next;
  isFresh = true;
  if (before) painter.leaveTrail(frame); // also where the next one comes before it is drawn
  byId("play").textContent = frame.playing ? "Pause" : "Play";
  if (frame.playing) unsay(PAUSED);
  if (!isNew) return;
  const energies = frame.sides.map((side) => side.kinetic + side.potential + side.elastic);
  if (!firstEnergy || firstEnergy.length !== energies.length) {
    firstEnergy = energies;
    scaleEnergy(plots.energy, frame);
  }
  plots.distance.add(frame.sides.map((side) => 100 * side.distance));
  plots.strain.add(frame.sides.map((side) => side.strainMax));
  plots.energy.add(energies.map((energy, i) => energy - firstEnergy[i]));
  plots.time.add(frame.sides.map((side) => side.stepUs / 1000));
}

function showNumbers() {
  const reached = frame.playing && frame.reached && pace.kind !== "slow" ? ` · ${short(frame.reached, 2)} ×` : "";
  byId("clock").textContent = `${frame.time.toFixed(2)} s · frame ${frame.frame}${reached}`;
  byId("high").textContent = painter.flies?.words ?? "";
  [...byId("legend").children].forEach((item, i) => {
    const side = frame.sides[i];
    if (!side) return;
    item.querySelector("span").textContent = (i > 0 ? percentText(100 * side.distance) : frame.sides.length > 1 ? "reference" : "")
      + (frame.playing ? "" : ` · state ${hashText(side.hash)}`);
  });
  const endMass = frame.sides[0].gone.length ? null : lastSides.end_mass; // its rope may be cut
  byId("verdict").textContent = verdict(sides, plots.distance.series, painter.model.masses, endMass, !isFilm);
  byId("counters").innerHTML = counterRows(frame);
  byId("stages").innerHTML = stageRows(frame, panel.stages ?? []);
  showKey(byId("key"), painter, frame);
  Object.values(plots).forEach((plot) => plot.draw());
}

function resize() {
  const ratio = Math.min(2, devicePixelRatio || 1);
  const width = Math.round(canvas.clientWidth * ratio), height = Math.round(canvas.clientHeight * ratio);
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  painter.top = ratio * document.querySelector("header").getBoundingClientRect().bottom;
}

function draw() {
  requestAnimationFrame(draw);
  pace.tick(performance.now(), frame, isFilm ? 0 : Number(byId("speed").value));
  if (!frame && painter.model) return; // what was shown stays until there is more
  resize();
  // In slow motion frames are far apart, and what is drawn leads from one to the next.
  const blend = before && period > 25 ? Math.min(1, (performance.now() - arrived) / period) : 1;
  if (frame) camera.follow(frame.sides[0].positions, painter.model.thickness, painter.whatStays());
  const look = painter.look(camera, blend), isNews = isFresh;
  if (isNews || look !== drawn) drawWorlds(look, blend); // a picture that stays the same costs nothing
  if (!frame || isTold || ++ticks % 6 && (frame.playing || !isNews)) return;
  showNumbers();
  isTold = true;
}

function drawWorlds(look, blend) {
  isFresh = isTold = false;
  drawn = look;
  if (frame) painter.update(frame, before, blend);
  painter.draw(camera); // an empty page, as where another one has the worlds, has a background
  if (frame) showTitles(byId("titles"), painter, sides);
}

function saveAs(name, text, type) {
  save(name, text, type);
  note(`Saved as ${name}.`);
}

async function saveFilm() {
  try {
    saveAs("plumb.html", await pageOf(recording), "text/html");
  } catch (error) {
    note("The page could not be saved: " + error.message, true);
  }
}

function setTool(tool) {
  const { disabled, title } = document.querySelector(`[data-tool="${tool}"]`);
  if (disabled) return note(title + ".");
  page.hands.tool = tool;
  for (const button of document.querySelectorAll("[data-tool]")) button.setAttribute("aria-pressed", button.dataset.tool === tool);
  byId("winch").hidden = tool !== "reel" || !winch;
  if (tool === "reel" && !winch) note("Click the rod that is to be reeled in or paid out.");
}

function reel(direction) {
  if (!winch || direction === reelRate) return;
  reelRate = direction;
  if (direction !== 0) page.sayIfPaused();
  send(requests.reel(winch.kind, winch.number, 0.25 * painter.size * direction));
}

const flip = (id) => { byId(id).click(); };
const togglePlay = () => send(frame?.playing ? requests.pause() : requests.play());
const setColour = (value) => {
  byId("colour").value = painter.colour = value;
  send(requests.values(value === "strain" || value === "tension" ? value : "none"));
};
const keys = {
  " ": togglePlay, ".": () => send(requests.step()), r: () => send(requests.reset()), o: () => flip("overlay"),
  t: () => flip("trails"), s: () => send(requests.record()), p: saveFilm, "?": () => byId("help").showModal(),
  f: () => camera.frame(painter.model),
  c: () => setColour(byId("colour").options[(byId("colour").selectedIndex + 1) % byId("colour").options.length].value),
  "[": () => reel(-1), "]": () => reel(1),
};
["pull", "cut", "fix", "reel", "throw"].forEach((tool, i) => { keys[i + 1] = () => setTool(tool); });

addEventListener("keydown", (event) => {
  if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches("select, input:not([type=range]):not([type=checkbox])") || byId("help").open) return;
  if (event.key === " " && event.target.matches("button")) return;
  const act = keys[event.key.toLowerCase()];
  if (!act) return;
  event.preventDefault();
  act();
});
addEventListener("keyup", (event) => { if ("[]".includes(event.key)) reel(0); });
byId("play").addEventListener("click", togglePlay);
byId("step").addEventListener("click", keys["."]);
byId("reset").addEventListener("click", keys.r);
byId("save").addEventListener("click", keys.s);
byId("film").addEventListener("click", saveFilm);
byId("ask").addEventListener("click", keys["?"]);
byId("speed").addEventListener("change", () => send(requests.speed(byId("speed").value)));
byId("colour").addEventListener("change", () => setColour(byId("colour").value));
byId("overlay").addEventListener("change", () => { painter.overlay = byId("overlay").checked; });
byId("trails").addEventListener("change", () => { painter.trails = byId("trails").checked; painter.clearTrails(); });
for (const button of document.querySelectorAll("[data-tool]")) button.addEventListener("click", () => setTool(button.dataset.tool));
for (const button of document.querySelectorAll("[data-rate]")) {
  button.addEventListener("pointerdown", () => reel(Number(button.dataset.rate)));
  for (const end of ["pointerup", "pointerleave"]) button.addEventListener(end, () => reel(0));
}
for (const kind of ["dragover", "dragleave", "drop"])
  addEventListener(kind, (event) => { event.preventDefault(); byId("drop").hidden = kind !== "dragover"; });
addEventListener("drop", async ({ dataTransfer }) => {
  const file = dataTransfer.files[0];
  if (!file) note("That is no file.", true);
  else if (file.size > 30e6) note(`${file.name} is larger than 30 MB.`, true);
  else panel.send(requests.load(file.name, await file.text() || " "));
});
foldWhy(byId("why"));
onSchemeChange(() => { if (lastSides) setSides(lastSides); });

// Shaders take longer to compile than all else: what needs none is shown before.
requestAnimationFrame(() => setTimeout(begin));
// Tests and the curious look at the page through this.
window.plumb = { page, camera, get painter() { return painter; }, get frame() { return frame; }, hashText, requests, decodeFrame };
