// Explains the control that is pointed at or has the focus, in one place, so that nothing moves. Others hear it.
import { CHOICES, choiceText, TERMS } from "./terms.js";

const idOf = (term) => "term-" + term.replace(/\W+/g, "-");
const controlOf = (row) => (row.matches("button, input, select, figure") ? row : row.querySelector("input, select") ?? row);

/** Lets a row, or a control of its own, be explained by a term. */
export function mean(row, term) {
  row.dataset.term = term;
  controlOf(row).setAttribute("aria-describedby", idOf(term));
  return row;
}

function textOf(row) {
  const { term } = row.dataset, control = controlOf(row), about = CHOICES[term]?.[control.value];
  return TERMS[term] + (about ? ` ${choiceText(term, control.value)}.` : "");
}

/** Explains what lies in `panel` at `place`, and lists all terms in `list`. */
export function explain(panel, place, list) {
  const usual = place.textContent;
  let shown = null, focused = null; // what is pointed at comes before what has the focus
  const show = () => {
    const row = [shown, focused].find((each) => each?.isConnected && TERMS[each.dataset.term]);
    place.textContent = row ? textOf(row) : usual;
  };
  const rowAt = ({ target }) => target.closest?.("[data-term]") ?? null;
  panel.addEventListener("pointerover", (event) => { shown = rowAt(event); show(); });
  panel.addEventListener("pointerleave", () => { shown = null; show(); });
  panel.addEventListener("focusin", (event) => { focused = shown = rowAt(event); show(); });
  panel.addEventListener("focusout", () => { focused = null; show(); });
  panel.addEventListener("change", show);
  for (const row of panel.querySelectorAll("[data-term]")) mean(row, row.dataset.term);
  list.replaceChildren(...Object.entries(TERMS).flatMap(([term, about]) => {
    const name = document.createElement("dt"), text = document.createElement("dd");
    name.textContent = term;
    text.id = idOf(term);
    text.textContent = [about, ...Object.keys(CHOICES[term] ?? {}).map((value) => choiceText(term, value) + ".")].join(" ");
    return [name, text];
  }));
}
