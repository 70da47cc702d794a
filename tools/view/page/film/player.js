// Shows a recording where a live page has a server. It takes the place of ../socket.js.

const MOST_PASSED = 1000; // ms, between two pictures: else the page was hidden

async function unpacked() {
  const text = atob(document.getElementById("recording").textContent);
  const bytes = Uint8Array.from(text, (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  const all = await new Response(stream).arrayBuffer();
  const end = new Uint8Array(all).indexOf(10);
  const { texts, sizes } = JSON.parse(new TextDecoder().decode(all.slice(0, end)));
  let at = end + 1;
  return { texts, frames: sizes.map((size) => all.slice(at, (at += size))) };
}

/** Adds a slider over so many frames. It calls `move` with the number of one, and `hold` with whether a pointer holds it. */
function addSlider(count, move, hold) {
  const slider = document.createElement("input");
  Object.assign(slider, { type: "range", id: "place", min: 0, max: count - 1, step: 1, title: "Move in the recording (arrow keys, too)" });
  slider.setAttribute("aria-label", "Place in the recording");
  slider.addEventListener("input", () => move(Number(slider.value)));
  slider.addEventListener("pointerdown", () => hold(true));
  for (const end of ["pointerup", "pointercancel"]) addEventListener(end, () => hold(false)); // also beside it
  document.getElementById("time").before(slider);
  return slider;
}

/** Calls `on.text` and `on.frame` as a server would. Returns a function that takes requests about time. */
export function connect(on) {
  let film = null, slider = null, isHeld = false, next = 0, playing = true, speed = 1, time = 0, last = 0;
  const timeOf = (number) => new DataView(film.frames[number]).getFloat64(8, true);
  const isOver = () => next + 1 >= film.frames.length;

  const show = () => {
    const view = new DataView(film.frames[next]), length = timeOf(film.frames.length - 1) - timeOf(0);
    view.setUint32(20, playing ? 1 : 0, true);
    view.setFloat32(24, speed, true); // that of the recording is not that of now
    on.frame(film.frames[next]);
    if (!isHeld) slider.value = next; // who is told a value in the middle of a drag ends it
    slider.setAttribute("aria-valuetext", `${(timeOf(next) - timeOf(0)).toFixed(2)} s of ${length.toFixed(1)} s`);
    document.getElementById("pace").textContent = `Recording of ${length.toFixed(1)} s${isOver() ? ", ended" : ""}`;
  };
  const go = (number) => {
    next = Math.min(number, film.frames.length - 1);
    time = timeOf(next);
  };
  // By the clock: a page that draws slowly leaves frames out.
  const tick = (now) => {
    requestAnimationFrame(tick);
    const passed = Math.min(MOST_PASSED, now - last), before = next;
    last = now;
    if (!playing || isHeld) return;
    time += (passed / 1000) * speed;
    while (!isOver() && timeOf(next + 1) <= time) ++next;
    if (isOver()) playing = false;
    if (next !== before || !playing) show();
  };
  const answers = {
    play: () => {
      playing = true;
      if (isOver()) go(0);
    },
    pause: () => { playing = false; },
    step: () => {
      playing = false;
      go(next + 1);
    },
    reset: () => go(0),
    speed: ({ value }) => { speed = Number(value); },
    values: () => {},
  };

  unpacked().then((read) => {
    film = read;
    slider = addSlider(film.frames.length, (number) => { go(number); show(); }, (holds) => { isHeld = holds; });
    film.texts.forEach(on.text);
    on.state("open", "");
    go(0);
    show();
    last = performance.now();
    requestAnimationFrame(tick);
  }, () => on.state("closed", "This page's recording cannot be read."));
  return (message) => {
    const request = JSON.parse(message);
    if (!film) return;
    if (!answers[request.do]) on.text({ kind: "note", refused: true, text: "This page shows a recording, which cannot be changed." });
    else {
      answers[request.do](request);
      show();
    }
  };
}
