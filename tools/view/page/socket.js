// The connection to the server, which comes back by itself when it is torn.

/** Connects and calls `on.text`, `on.frame` and `on.state`. Returns a function that sends a request. */
export function connect(on) {
  let socket = null, wait = 500, queue = [];
  const open = () => {
    const url = new URL("socket", location.href);
    url.protocol = "ws:";
    socket = new WebSocket(url);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      wait = 500;
      on.state("open", "");
      queue.forEach((message) => socket.send(message));
      queue = [];
    };
    socket.onmessage = ({ data }) => (typeof data === "string" ? on.text(JSON.parse(data)) : on.frame(data));
    socket.onclose = ({ code, reason }) => {
      on.state("closed", code === 1013 ? reason
        : "The connection to plumb view is gone. It comes back by itself while the program runs.");
      setTimeout(open, wait);
      wait = Math.min(2 * wait, 5000);
    };
  };
  open();
  return (message) => {
    if (socket.readyState === WebSocket.OPEN) socket.send(message);
    else if (queue.length < 20) queue.push(message);
  };
}
