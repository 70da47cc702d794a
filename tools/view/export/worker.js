// What an exported page has in place of page/socket.js: worlds run in a worker, in WebAssembly.

const SAYS = "This page runs plumb in WebAssembly: on one thread, with vectors of 128 bits. Its bits are those of the program, "
  + "which runs larger worlds on all threads: plumb view.";

function sign() {
  for (const place of [document.querySelector("#help form"), document.getElementById("counters")]) {
    const text = document.createElement("p");
    text.className = "exported";
    text.textContent = SAYS;
    place.before(text);
  }
}

/** Starts the worker and calls `on.text`, `on.frame` and `on.state`. Returns a function that sends a request. */
export function connect(on) {
  const textOf = (id) => document.getElementById(id).textContent;
  const url = URL.createObjectURL(new Blob([textOf("kernel")], { type: "text/javascript" }));
  const worker = new Worker(url);
  worker.onmessage = ({ data }) => {
    if (typeof data === "string") return on.text(JSON.parse(data));
    on.frame(data);
    worker.postMessage(null);
  };
  worker.onerror = ({ message }) => on.state("closed", `The worlds of this page stand still: ${message || "the browser does not run them"}.`);
  worker.postMessage(textOf("start"));
  sign();
  return (message) => worker.postMessage(message);
}
