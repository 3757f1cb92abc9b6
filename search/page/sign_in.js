/**
 * The sign-in page: the token becomes a cookie, and the address opens as it was, with its fragment.
 */

const WRONG = "This is not the token of this server.";
const form = /** @type {HTMLFormElement} */ (document.getElementById("sign-in"));
const said = /** @type {HTMLElement} */ (document.getElementById("said"));
const token = /** @type {HTMLInputElement} */ (document.getElementById("token"));

form.addEventListener("submit", async (event) => {
  event.preventDefault();
  said.textContent = "";
  const given = token.value.trim();
  try {
    if (!/^[!-~]+$/.test(given)) throw new RangeError();
    const response = await fetch("/sign-in", { method: "POST", headers: { Authorization: `Bearer ${given}` } });
    if (response.ok) location.reload();
    else said.textContent = response.status === 401 ? WRONG : `The server responded with status ${response.status}.`;
  } catch (error) {
    said.textContent = error instanceof RangeError ? WRONG : "The server does not respond. Is motionseek serve still running?";
  }
  token.select();
});
