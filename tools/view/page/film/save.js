// Hands files to whoever looks at the page.
import { makePage } from "./bundle.js";

/** Saves a text as a file. */
export function save(name, text, type) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([text], { type }));
  link.download = name;
  link.click();
  URL.revokeObjectURL(link.href);
}

/** Returns the page of a recording, which needs no server. Throws an Error where this page has no files to make it from. */
export async function pageOf(recording) {
  if (location.protocol === "file:") throw new Error("a page without a server has no files to save it from");
  return makePage(recording, async (name) => (await fetch(name)).text());
}
