/**
 * Keyboard shortcuts, their list in the help dialog, and the switch that turns those of one character off.
 */

import { byId, el } from "./dom.js";

/**
 * @typedef {{key: string, says: string, shown?: string, viewer?: boolean, act: () => void}} Key
 *   `viewer`: active only while a clip is open (true), only while none is (false), or always
 */

/** @param {Key[]} keys @param {() => boolean} viewing whether a clip is open */
export function listen(keys, viewing) {
  const single = byId("single-keys");
  single.checked = localStorage.getItem("single-keys") !== "off";
  single.addEventListener("change", () => localStorage.setItem("single-keys", single.checked ? "on" : "off"));
  addEventListener("keydown", (event) => {
    const target = /** @type {HTMLElement} */ (event.target);
    const typing = target.matches("input:not([type=checkbox]), select, textarea");
    if (event.key === "Escape" && typing) return target.blur();
    if (event.ctrlKey || event.metaKey || event.altKey || typing || target.closest("dialog")) return;
    if (event.key === " " && target.matches("button, input, a.button")) return;
    if (event.key.length === 1 && event.key !== " " && !single.checked) return;
    const found = keys.find(({ key, viewer }) => key === event.key && (viewer === undefined || viewer === viewing()));
    if (!found) return;
    event.preventDefault();
    found.act();
  });
  const shown = [...new Map(keys.map(({ key, shown: name, says }) => [says, name ?? key])).entries()];
  const rest = /** @type {[string, string][]} */ ([["move between figures or points", "← → ↑ ↓"], ["open", "Enter"]]);
  byId("keys").replaceChildren(...[...shown, ...rest].flatMap(([says, key]) => [el("dt", {}, el("kbd", {}, key)), el("dd", {}, says)]));
}
