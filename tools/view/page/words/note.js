// A note over the worlds, which goes by itself.

const STAYS = 6000; // ms
const place = document.getElementById("note");
let timer = 0;

/** Shows a note; none where there is no text. One that `stays` does so until the next. */
export function note(text, refused = false, stays = false) {
  place.textContent = text;
  place.classList.toggle("refused", refused);
  place.hidden = !text;
  clearTimeout(timer);
  if (!stays) timer = setTimeout(() => { place.hidden = true; }, STAYS);
}

/** Takes a note away that still says this. */
export function unsay(text) {
  if (place.textContent === text) note("");
}

/** Says why another page has the worlds, with a button that takes them over. */
export function offerTakeover(text, takeOver) {
  // The page tries again by itself meanwhile: a button that is about to be pressed stays.
  if (!place.hidden && place.querySelector("button")) return;
  note(text, true, true);
  const button = document.createElement("button");
  Object.assign(button, { textContent: "Use it here", title: "The other page stops showing these worlds" });
  button.addEventListener("click", takeOver);
  place.append(" ", button);
}
