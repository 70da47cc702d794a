// Makes a single page of this one's files and of a recording, which needs no server and has no links.

const LIVE = "socket.js", FILM = "film/player.js";

const folderOf = (file) => file.split("/").slice(0, -1);

/** Returns the name of the file that `from` imports as `path`. */
function resolved(path, from) {
  const parts = folderOf(from);
  for (const part of path.split("/")) {
    if (part === "..") parts.pop();
    else if (part !== ".") parts.push(part);
  }
  const name = parts.join("/");
  return name === LIVE ? FILM : name;
}

/** Returns a module as a call that enters its exports in a table. A page from a file cannot import modules. */
export function asFunction(name, text) {
  const names = [...text.matchAll(/^export (?:const|let|class|(?:async )?function) (\w+)/gm)].map((match) => match[1]);
  const body = text
    .replace(/^import \* as (\w+) from "(.+?)";/gm, (_, all, path) => `const ${all} = modules["${resolved(path, name)}"];`)
    .replace(/^import \{(.+?)\} from "(.+?)";/gm, (_, some, path) =>
      `const {${some.replace(/ as /g, ": ")}} = modules["${resolved(path, name)}"];`)
    .replace(/^export /gm, "");
  return `modules["${name}"] = (() => {\n${body}\nreturn { ${names.join(", ")} };\n})();\n`;
}

/** Reads a module and those that it imports, each once, in an order in which they can run. */
async function collect(name, read, done = new Map()) {
  if (done.has(name)) return done;
  const text = await read(name);
  for (const [, path] of text.matchAll(/^import .+? from "(.+?)";/gm)) await collect(resolved(path, name), read, done);
  done.set(name, asFunction(name, text));
  return done;
}

/** Returns bytes as text of 64 letters, compressed. */
async function packed(blob) {
  const bytes = new Uint8Array(await new Response(blob.stream().pipeThrough(new CompressionStream("gzip"))).arrayBuffer());
  let text = "";
  for (let i = 0; i < bytes.length; i += 0x8000) text += String.fromCharCode(...bytes.subarray(i, i + 0x8000));
  return btoa(text);
}

/** Returns the text of the page. `read` gives the text of a file of this page. */
export async function makePage(recording, read) {
  const head = JSON.stringify({ texts: Object.values(recording.texts), sizes: recording.frames.map((f) => f.byteLength) });
  const data = await packed(new Blob([head, "\n", ...recording.frames]));
  // A browser ends a script at its closing tag, wherever that stands.
  const modules = [...(await collect("main.js", read)).values()].join("").replaceAll("</script", "<\\/script");
  const style = await read("style.css");
  return (await read("index.html"))
    .replace(/^<(link|script)\b.*\n/gm, "")
    .replace("</head>", () => `<style>\n${style}</style>\n</head>`)
    .replace("<body>", '<body class="film">')
    .replace("</body>", () => `<script type="text/plain" id="recording">${data}</script>\n`
      + `<script>\n"use strict";\nconst modules = {};\n${modules}</script>\n</body>`);
}
