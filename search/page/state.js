/**
 * What is shown, kept in the address after the `#`: every view has a link, and the browser's back button works.
 */

/**
 * @typedef {object} State
 * @property {string} q            the sentence
 * @property {string} moments      "1": ask for moments rather than clips
 * @property {string} min          filters: seconds at least
 * @property {string} max          seconds at most
 * @property {string} path         a pattern
 * @property {string} format
 * @property {string} rig          a kind of skeleton, as the server calls it
 * @property {string} captioned    "true" or "false"
 * @property {string} like         a clip: show what is like it…
 * @property {string} from         …or like this span of it
 * @property {string} to
 * @property {string} ids          clips picked on the map, with commas
 * @property {string} view         "map" or ""
 * @property {string} clip         the clip that is open
 * @property {string} a            in point, seconds
 * @property {string} b            out point
 * @property {string[]} ask        further sentences asked of the open clip
 */

const NAMES = /** @type {const} */ (["q", "moments", "min", "max", "path", "format", "rig", "captioned", "like", "from", "to", "ids", "view", "clip", "a", "b"]);

/** @returns {State} */
export function read(hash = location.hash) {
  const given = new URLSearchParams(hash.replace(/^#/, ""));
  const state = Object.fromEntries(NAMES.map((name) => [name, given.get(name) ?? ""]));
  return /** @type {State} */ ({ ...state, ask: given.getAll("ask").slice(0, 8) });
}

/** The address of the present state with changes. @param {Partial<State>} changes */
export function link(changes) {
  const state = { ...read(), ...changes };
  const given = new URLSearchParams();
  for (const name of NAMES) if (state[name]) given.set(name, state[name]);
  for (const sentence of state.ask) given.append("ask", sentence);
  return `#${given}`;
}

/** What closes an open clip. */
export const CLOSED = { clip: "", a: "", b: "", ask: [] };

/** @type {((state: State) => void)[]} */
const listeners = [];

/** @param {(state: State) => void} listener called with every state there comes to be */
export function subscribe(listener) {
  listeners.push(listener);
}

const tell = () => listeners.forEach((listener) => listener(read()));

/** Go on to a state; `quietly` leaves no step for the back button. @param {Partial<State>} changes */
export function go(changes, { quietly = false } = {}) {
  const address = link(changes);
  if (address === (location.hash || "#")) return;
  history[quietly ? "replaceState" : "pushState"](null, "", address);
  tell();
}

/** Note a change in the address that the page shows already. @param {Partial<State>} changes */
export const note = (changes) => history.replaceState(null, "", link(changes));

addEventListener("popstate", tell);

/** The filters as the server takes them. @param {State} state */
export const filters = ({ min, max, path, format, rig, captioned }) => ({
  min_duration: min, max_duration: max, path, format, rig, captioned,
}); // prettier-ignore
