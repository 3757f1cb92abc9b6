/**
 * Light or dark: what the system says, until the user chooses.
 */

const dark = matchMedia("(prefers-color-scheme: dark)");
const chosen = localStorage.getItem("theme");
if (chosen) document.documentElement.dataset.theme = chosen;

/** @type {() => void} */
let repaint = () => {};

/** @param {() => void} listener called when colours have changed */
export function onTheme(listener) {
  repaint = listener;
  dark.addEventListener("change", listener);
  matchMedia("(forced-colors: active)").addEventListener("change", listener);
}

/** Change to the other one, and keep that. */
export function changeTheme() {
  const now = document.documentElement.dataset.theme ?? (dark.matches ? "dark" : "light");
  const next = now === "dark" ? "light" : "dark";
  localStorage.setItem("theme", next);
  document.documentElement.dataset.theme = next;
  repaint();
}
