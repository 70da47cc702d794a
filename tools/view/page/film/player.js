// Shows a recording where a live page has a server. It takes the place of ../socket.js.

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

/** Calls `on.text` and `on.frame` as a server would. Returns a function that takes requests about time. */
export function connect(on) {
  let film = null, next = 0, playing = true, speed = 1, due = 0;

  const show = () => {
    const frame = film.frames[next];
    const view = new DataView(frame);
    view.setUint32(20, playing ? 1 : 0, true);
    on.frame(frame);
  };
  const tick = (now) => {
    requestAnimationFrame(tick);
    if (!playing || now < due) return;
    due = Math.max(due + 1000 / 60 / speed, now - 50);
    if (next + 1 >= film.frames.length) playing = false;
    show();
    if (playing) ++next;
  };
  const answers = {
    play: () => {
      playing = true;
      if (next + 1 >= film.frames.length) next = 0;
    },
    pause: () => { playing = false; },
    step: () => {
      playing = false;
      next = Math.min(next + 1, film.frames.length - 1);
    },
    reset: () => { next = 0; },
    speed: ({ value }) => { speed = Number(value); },
    values: () => {},
  };

  unpacked().then((read) => {
    film = read;
    film.texts.forEach(on.text);
    on.state("open", "");
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
