/**
 * Files that are dropped on the page or chosen in the file dialog: several at once, folders, and files that need others.
 */

import * as api from "./api.js";
import { byId, el } from "./dom.js";
import { CLOSED, go } from "./state.js";

const MOST = 32; // motions that the server keeps
const LISTED = 6; // reasons that are shown

/** @typedef {{ending: string, companion: string | null, same_name: boolean}} Format */

/** @type {Promise<Format[]> | null} */
let known = null;
const formats = () =>
  (known ??= api.formats().catch((error) => {
    known = null;
    throw error;
  }));

/** Take files from now on. */
export function onFiles() {
  const holdsFiles = (/** @type {DragEvent} */ event) => event.dataTransfer?.types.includes("Files");
  let depth = 0; // dragenter and dragleave fire for every element under the pointer
  const show = (/** @type {number} */ now) => {
    if (now > 0 && depth <= 0) formats().then((rows) => (byId("endings").textContent = rows.map(({ ending }) => ending).join(" ")), () => {});
    depth = now;
    byId("drop").hidden = depth <= 0;
  };
  addEventListener("dragenter", (event) => holdsFiles(event) && show(depth + 1));
  addEventListener("dragleave", (event) => holdsFiles(event) && show(depth - 1));
  addEventListener("dragover", (event) => holdsFiles(event) && event.preventDefault());
  addEventListener("drop", async (event) => {
    if (!holdsFiles(event)) return;
    event.preventDefault();
    show(0);
    open(await dropped(/** @type {DataTransfer} */ (event.dataTransfer)));
  });
  byId("pick").addEventListener("click", () => byId("file").click());
  byId("file").addEventListener("change", () => {
    const files = [...byId("file").files].map((file) => ({ file, folder: "" }));
    byId("file").value = "";
    open(files);
  });
  byId("told-close").addEventListener("click", () => tell(""));
}

/** @typedef {{file: File, folder: string}} Given */

/** All files of a drop, those in folders too. @param {DataTransfer} data @returns {Promise<Given[]>} */
async function dropped(data) {
  const entries = [...data.items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
  if (!entries.some((entry) => entry.isDirectory)) return [...data.files].map((file) => ({ file, folder: "" }));
  return (await Promise.all(entries.map((entry) => walk(entry, "")))).flat();
}

/** @param {any} entry @param {string} folder @returns {Promise<Given[]>} */
async function walk(entry, folder) {
  if (entry.name.startsWith(".")) return [];
  if (entry.isFile) return [{ file: await new Promise((done, fail) => entry.file(done, fail)), folder }];
  const reader = entry.createReader();
  const found = [];
  for (;;) {
    const some = await new Promise((done, fail) => reader.readEntries(done, fail)); // at most a hundred at a time
    if (!some.length) return (await Promise.all(found.map((inner) => walk(inner, `${folder}${entry.name}/`)))).flat();
    found.push(...some);
  }
}

const ending = (/** @type {string} */ name) => name.slice(name.lastIndexOf(".")).toLowerCase();
const stem = (/** @type {string} */ name) => name.slice(0, name.lastIndexOf(".")).toLowerCase();

/** The motions among files, each with the files that it may need, and what belongs to none. @param {Given[]} files @param {Format[]} rows */
function grouped(files, rows) {
  const byEnding = new Map(rows.map((row) => [row.ending, row]));
  const companions = new Set(rows.map((row) => row.companion));
  const motions = files.filter(({ file }) => byEnding.has(ending(file.name)) || !companions.has(ending(file.name)));
  return motions.map(({ file, folder }) => {
    const row = byEnding.get(ending(file.name));
    const beside = row?.companion ? files.filter((other) => other.folder === folder && ending(other.file.name) === row.companion && (!row.same_name || stem(other.file.name) === stem(file.name))) : [];
    return { name: folder + file.name, known: Boolean(row), files: [file, ...beside.map((other) => other.file)] };
  });
}

/** Read files, and show what was in them. @param {Given[]} files */
async function open(files) {
  if (!files.length) return;
  let rows;
  try {
    rows = await formats();
  } catch (error) {
    return tell(/** @type {Error} */ (error).message);
  }
  const all = grouped(files, rows);
  // Of many files those of other kinds are passed over; of a few the server says what is wrong with each.
  const motions = all.filter((one) => one.known || all.length <= LISTED);
  const faults = [];
  if (!all.length) faults.push(`${files[0].file.name} is a skeleton without motion: drop the files that belong to it, too`);
  if (all.length > motions.length) faults.push(`${all.length - motions.length} files are of no kind that can be read`);
  if (motions.length > MOST) faults.push(`only the first ${MOST} of ${motions.length} motions were read; index the folder to search all: motionseek index FOLDER`);
  const keys = [];
  for (const [i, one] of motions.slice(0, MOST).entries()) {
    tell(motions.length > 1 ? `Reading ${i + 1} of ${Math.min(motions.length, MOST)}: ${one.name}…` : `Reading ${one.name}…`);
    try {
      keys.push(...(await api.upload(one.name, one.files)).map(({ clip }) => clip));
    } catch (error) {
      const { message } = /** @type {Error} */ (error);
      faults.push(message.startsWith(one.name) ? message : `${one.name}: ${message}`);
      if (/** @type {api.ApiError} */ (error).status === 0) break;
    }
  }
  tell(keys.length ? "" : "Nothing could be read.", faults);
  if (keys.length === 1) go({ ...CLOSED, q: "", clip: keys[0] });
  if (keys.length > 1) go({ ...CLOSED, q: "", like: "", view: "", ids: keys.slice(-MOST).join(",") });
}

/** Say something above all views, until it is closed. @param {string} text @param {string[]} [faults] */
function tell(text, faults = []) {
  byId("told").hidden = !text && !faults.length;
  const more = faults.length - LISTED;
  byId("told-text").replaceChildren(
    ...(text ? [el("p", {}, text)] : []),
    ...faults.slice(0, LISTED).map((fault) => el("p", {}, fault)),
    ...(more > 0 ? [el("p", {}, `and ${more} more`)] : []),
  );
}
