// The connection to the server, which comes back by itself when it is torn.

const TAKEN = new Uint8Array(0);
const REFUSED = 1013; // the code that a connection closes with where another page has the worlds
const GONE = "The connection to plumb view is gone. It comes back by itself while the program runs.";
const WOKE = "This page slept, and the browser closed its connection. It goes on at the present; plots and recording begin anew.";

/**
 * Connects and calls `on.text`, `on.frame` and `on.state`, which where another page has the worlds is also given a
 * function that takes them over. Returns a function that sends a request.
 */
export function connect(on) {
  let socket = null, wait = 500, queue = [], slept = false, isRefused = false, timer = 0;
  const takeOver = () => open("", "takeover");
  const open = (said = "", name = "socket") => {
    clearTimeout(timer);
    socket?.close();
    const url = new URL(name, location.href);
    url.protocol = "ws:";
    const own = new WebSocket(url);
    socket = own;
    own.binaryType = "arraybuffer";
    let isWelcome = false;
    const enter = () => {
      if (isWelcome) return;
      isWelcome = true;
      isRefused = false;
      wait = 500;
      on.state("open", said);
      queue.forEach((message) => own.send(message));
      queue = [];
    };
    own.onopen = () => {
      if (!isRefused) enter(); // else it may be refused again, which is said only after it opened
    };
    own.onmessage = ({ data }) => {
      if (own !== socket) return;
      enter();
      if (typeof data === "string") return on.text(JSON.parse(data));
      own.send(TAKEN); // the server sends no more than a few frames to a page that does not say so
      on.frame(data);
    };
    own.onclose = ({ code, reason }) => {
      if (own !== socket) return; // a later one took its place
      if (slept && code !== REFUSED) {
        slept = false;
        timer = setTimeout(open, 100, WOKE); // by then the server knows that the old connection is gone
        return;
      }
      isRefused = code === REFUSED;
      if (isRefused) on.state("closed", reason, takeOver);
      else on.state("closed", GONE);
      timer = setTimeout(open, wait);
      wait = Math.min(2 * wait, 5000);
    };
  };
  // Browsers close connections of pages that they freeze; that is no failure of the server.
  document.addEventListener("freeze", () => { slept = true; });
  open();
  return (message) => {
    if (socket.readyState === WebSocket.OPEN) socket.send(message);
    else if (queue.length < 20) queue.push(message);
  };
}
