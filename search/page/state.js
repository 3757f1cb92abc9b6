/**
 * The state of the page, kept in the URL fragment: every view has a link, and the back button works.
 */

/**
 * @typedef {object} State
 * @property {string} q            the sentence
 * @property {string} moments      "1": ask for moments rather than clips
 * @property {string} min          filters: minimum duration in seconds
 * @property {string} max          maximum duration in seconds
 * @property {string} path         a glob
 * @property {string} format
 * @property {string} rig          the name of a rig
 * @property {string} captioned    "true" or "false"
 * @property {string} like         a clip: show similar clips…
 * @property {string} from         …or clips similar to this span of it
 * @property {string} to
 * @property {string} ids          clips selected on the map, separated by commas
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

/** The fragment of the current state with changes. @param {Partial<State>} changes */
export function link(changes) {
  const state = { ...read(), ...changes };
  const given = new URLSearchParams();
  for (const name of NAMES) if (state[name]) given.set(name, state[name]);
  for (const sentence of state.ask) given.append("ask", sentence);
  return `#${given}`;
}

/** The changes that close an open clip. */
export const CLOSED = { clip: "", a: "", b: "", ask: [] };

/** @type {((state: State) => void)[]} */
const listeners = [];

/** @param {(state: State) => void} listener called with every new state */
export function subscribe(listener) {
  listeners.push(listener);
}

const tell = () => listeners.forEach((listener) => listener(read()));

/** Change the state; `quietly` adds no history entry. @param {Partial<State>} changes */
export function go(changes, { quietly = false } = {}) {
  const address = link(changes);
  if (address === (location.hash || "#")) return;
  history[quietly ? "replaceState" : "pushState"](null, "", address);
  tell();
}

/** Update the fragment for a change that is shown already. @param {Partial<State>} changes */
export const note = (changes) => history.replaceState(null, "", link(changes));

addEventListener("popstate", tell);

/** The filters as the server takes them. @param {State} state */
export const filters = ({ min, max, path, format, rig, captioned }) => ({
  min_duration: min, max_duration: max, path, format, rig, captioned,
}); // prettier-ignore
