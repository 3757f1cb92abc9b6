/**
 * Files that are dropped on the page or chosen in the file dialog.
 */

import { byId } from "./dom.js";

/** @param {(file: File) => void} open called with each file */
export function onFiles(open) {
  const holdsFiles = (/** @type {DragEvent} */ event) => event.dataTransfer?.types.includes("Files");
  let depth = 0; // dragenter and dragleave fire for every element under the pointer
  const show = (/** @type {number} */ now) => {
    depth = now;
    byId("drop").hidden = depth <= 0;
  };
  addEventListener("dragenter", (event) => holdsFiles(event) && show(depth + 1));
  addEventListener("dragleave", (event) => holdsFiles(event) && show(depth - 1));
  addEventListener("dragover", (event) => holdsFiles(event) && event.preventDefault());
  addEventListener("drop", (event) => {
    if (!holdsFiles(event)) return;
    event.preventDefault();
    show(0);
    const file = event.dataTransfer?.files[0];
    if (file) open(file);
  });
  byId("pick").addEventListener("click", () => byId("file").click());
  byId("file").addEventListener("change", () => {
    const file = byId("file").files[0];
    byId("file").value = "";
    if (file) open(file);
  });
}
