/**
 * Filters that are typed into the search box: `waves tag:hero`, `path:"my takes"`.
 */

const TOKEN = /(^|\s)(tag|collection|path|folder|format|rig):("[^"]*"|\S+)/gi;

/**
 * The sentence of a text, and the filters that are in it.
 * @param {string} text @returns {{q: string, given: Record<string, string>}}
 */
export function parsed(text) {
  /** @type {Record<string, string>} */
  const given = {};
  const rest = text.replace(TOKEN, (_, before, name, value) => {
    given[name.toLowerCase() === "folder" ? "path" : name.toLowerCase()] = value.replace(/^"|"$/g, "");
    return before;
  });
  return { q: rest.trim().replace(/\s+/g, " "), given };
}
