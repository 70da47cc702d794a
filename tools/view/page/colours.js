// Colours of worlds, values, sleepers and islands, for light and for dark.

const isDark = matchMedia("(prefers-color-scheme: dark)");
export const onSchemeChange = (then) => isDark.addEventListener("change", then);

const hex = (text) => [1, 3, 5].map((i) => parseInt(text.slice(i, i + 2), 16) / 255);

const light = { back: "#f6f7f9", ink: "#1c2430", grid: "#8a94a6", ground: "#c3cad6", fixed: "#1c2430",
                sides: ["#8b95a7", "#2563eb", "#e8590c", "#0f9d6b"] };
const dark = { back: "#11151c", ink: "#e6eaf2", grid: "#566074", ground: "#39435a", fixed: "#f2f5fa",
               sides: ["#9aa5b8", "#5b9bff", "#ff8c42", "#34d399"] };

export const theme = () => (isDark.matches ? dark : light);
export const rgb = (name) => hex(theme()[name]);
export const sideText = (i, count) => theme().sides[count === 1 ? 1 : i % 4];
export const sideColour = (i, count) => hex(sideText(i, count));

const stops = [[0.21, 0.46, 0.80], [0.55, 0.72, 0.82], [0.86, 0.86, 0.80], [0.95, 0.66, 0.35], [0.80, 0.18, 0.16]];

/** Returns the colour of a value between -1 (blue) and 1 (red). */
export function diverging(value) {
  const t = Math.min(3.9999, Math.max(0, (value + 1) * 2));
  const i = Math.floor(t), f = t - i;
  return stops[i].map((c, k) => c + f * (stops[i + 1][k] - c));
}

/** Returns one of many colours that lie well apart. */
export function islandColour(island) {
  const hue = (island * 0.618034) % 1, l = isDark.matches ? 0.66 : 0.5, s = 0.6;
  const f = (n) => {
    const k = (n + hue * 12) % 12;
    return l - s * Math.min(l, 1 - l) * Math.max(-1, Math.min(k - 3, 9 - k, 1));
  };
  return [f(0), f(8), f(4)];
}

export const mixed = (a, b, t) => a.map((x, i) => x + t * (b[i] - x));
