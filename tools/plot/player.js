// Plays the replays of a page, each where its numbers stand. Without this script the page has stills alone.
(() => {
  "use strict";
  const PAUSE_AT_END = 1; // seconds until a replay begins again
  const MOST_DOTS = 2; // per CSS pixel: more are not seen

  const create = (tag, more = {}, children = []) => {
    const element = Object.assign(document.createElement(tag), more);
    element.append(...children);
    return element;
  };

  /** Returns frames in metres. The page has millimetres, and of each frame what changed since the one before. */
  function unpacked(frames) {
    const now = (frames[0] ?? []).map(() => 0);
    return frames.map((frame) => Float32Array.from(frame, (change, i) => (now[i] += change) / 1000));
  }

  /** Returns the ends of all lines at a time between two frames. */
  function placesAt({ frames }, at) {
    const i = Math.min(Math.floor(at), frames.length - 1), next = frames[Math.min(i + 1, frames.length - 1)];
    const share = Math.min(1, at - i);
    return frames[i].map((place, k) => place + share * (next[k] - place));
  }

  /** Orders lines from the farthest to the nearest. Of two that are about as far, the thicker one is behind. */
  function order(lines, places) {
    const depth = lines.map((_, i) => Math.round(50 * (places[6 * i + 2] + places[6 * i + 5])));
    return lines.map((_, i) => i).sort((a, b) => depth[a] - depth[b] || lines[b].radius - lines[a].radius);
  }

  /** Draws a run on a canvas as wide as its column, in the colours of the page. */
  function draw(canvas, run, at, { left, right, top }) {
    const style = getComputedStyle(canvas), colour = (name) => style.getPropertyValue("--" + name);
    const ratio = Math.min(MOST_DOTS, devicePixelRatio || 1), scale = canvas.clientWidth / (right - left);
    const under = 10, width = canvas.clientWidth, height = scale * top + under; // CSS pixels
    const dots = [Math.round(ratio * width), Math.round(ratio * height)];
    if (canvas.width !== dots[0] || canvas.height !== dots[1]) [canvas.width, canvas.height] = dots;
    const pen = canvas.getContext("2d"), x = (metres) => scale * (metres - left), y = (metres) => scale * (top - metres);
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.lineCap = "round";
    const stroke = (a, b, thickness, name) => {
      pen.lineWidth = thickness;
      pen.strokeStyle = colour(name);
      pen.beginPath();
      pen.moveTo(...a);
      pen.lineTo(...b);
      pen.stroke();
    };
    const places = placesAt(run, at);
    for (const i of order(run.lines, places)) {
      const [ax, ay, , bx, by] = places.subarray(6 * i);
      const { radius, look } = run.lines[i], a = [x(ax), y(ay)], b = [x(bx), y(by)];
      stroke(a, b, 2 * scale * radius + 0.8, "back"); // a rim tells limbs apart that lie over each other
      stroke(a, b, 2 * scale * radius - 0.8, look);
    }
    stroke([0, y(0)], [width, y(0)], 1.5, "ground");
    // A mark shows where the figure stood.
    pen.fillStyle = colour("ground");
    pen.fill(new Path2D(`M${x(0)} ${y(0)} l-5 9 h10 z`));
  }

  /** A clock that runs while its replay is in sight, and begins again after the end. */
  class Clock {
    constructor(length, show) {
      Object.assign(this, { length, show, time: 0, speed: 1, isPlaying: false, isSeen: false, last: null });
    }

    set(changes) {
      const ran = this.runs();
      Object.assign(this, changes);
      if (!ran && this.runs()) {
        this.last = null;
        requestAnimationFrame((now) => this.tick(now));
      }
      this.show(this.time);
    }

    runs() {
      return this.isPlaying && this.isSeen;
    }

    tick(now) {
      if (!this.runs()) return;
      requestAnimationFrame((then) => this.tick(then));
      // A tab that slept goes on where it was.
      const passed = Math.min(0.1, (now - (this.last ?? now)) / 1000);
      this.last = now;
      this.time += this.speed * passed;
      if (this.time > this.length + PAUSE_AT_END) this.time = 0;
      this.show(this.time);
    }
  }

  function controls(clock) {
    const play = create("button", { type: "button" });
    const time = create("input", { type: "range", min: 0, max: clock.length, step: "any", value: 0, ariaLabel: "Time" });
    const speed = create("select", { ariaLabel: "Speed" }, [["1", "1 ×"], ["0.25", "1/4 ×"]].map(
      ([value, textContent]) => create("option", { value, textContent })));
    const said = create("output");
    play.addEventListener("click", () => clock.set({
      isPlaying: !clock.isPlaying, time: !clock.isPlaying && clock.time >= clock.length ? 0 : clock.time }));
    time.addEventListener("input", () => clock.set({ isPlaying: false, time: Number(time.value) }));
    speed.addEventListener("change", () => clock.set({ speed: Number(speed.value) }));
    const show = (now) => {
      play.textContent = clock.isPlaying ? "Pause" : "Play";
      time.value = now;
      said.textContent = Math.min(now, clock.length).toFixed(2) + " s";
    };
    return { bar: create("div", { className: "time" }, [play, time, said, speed]), show };
  }

  function begin(numbers) {
    const replay = JSON.parse(numbers.textContent);
    const runs = replay.runs.map((run) => ({ ...run, frames: unpacked(run.frames) })).filter((run) => run.frames.length);
    const longest = Math.max(0, ...runs.map((run) => run.frames.length - 1));
    const canvases = runs.map(({ title }) => create("canvas", { role: "img", ariaLabel: "Replay: " + title }));
    const paint = (time) => runs.forEach((run, i) => draw(canvases[i], run, time / replay.frame_length, replay));
    const clock = new Clock(longest * replay.frame_length, (time) => {
      bar.show(time);
      paint(time);
    });
    const bar = controls(clock);
    const columns = runs.map(({ title }, i) => create("div", {}, [create("p", { textContent: title }), canvases[i]]));
    numbers.after(create("figure", { className: "replay" }, [create("div", { className: "runs" }, columns), bar.bar]));
    const redraw = () => paint(clock.time);
    new ResizeObserver(redraw).observe(canvases[0]);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
    new IntersectionObserver(([{ isIntersecting }]) => clock.set({ isSeen: isIntersecting })).observe(canvases[0]);
    // Who asks for less motion presses Play.
    clock.set({ isPlaying: !matchMedia("(prefers-reduced-motion: reduce)").matches });
  }

  document.querySelectorAll("script.replay").forEach(begin);
})();
