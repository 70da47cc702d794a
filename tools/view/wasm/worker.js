// The end of the worker's script, behind what Emscripten writes. It hears the page, which says what it would say to a
// server, keeps time, and sends what worlds say. A frame that the page has not taken yet is replaced by the next.
let hasBegun = false, isBusy = false, waiting = null, timer = 0;

function sayText(text) {
  postMessage(text);
}

function sayFrame(buffer) {
  waiting = buffer;
  if (!isBusy) sendFrame();
}

function sendFrame() {
  isBusy = waiting !== null;
  if (isBusy) postMessage(waiting, [waiting]);
  waiting = null;
}

function withText(call, text) {
  const size = lengthBytesUTF8(text) + 1;
  const at = _malloc(size);
  stringToUTF8(text, at, size);
  call(at);
  _free(at);
}

function tick() {
  clearTimeout(timer);
  const wait = _plumb_tick();
  if (wait >= 0) timer = setTimeout(tick, wait);
}

/** Does what the page says: a start first, then requests. `null` says that it has taken a frame. */
function hear(message) {
  if (message === null) return sendFrame();
  withText(hasBegun ? _plumb_obey : _plumb_begin, message);
  hasBegun = true;
  tick();
}

onmessage = ({ data }) => hear(data);
