// Writes the input of a form as the TOML file the command line reads, so that a run made here can be repeated there.

function text(value) {
  // JSON escapes are TOML escapes, as long as the delete character is spelt out too.
  return JSON.stringify(value).replaceAll("\u007f", "\\u007F");
}

function key(name) {
  return /^[A-Za-z0-9_-]+$/.test(name) ? name : text(name);
}

function inline(value) {
  if (typeof value === "string") return text(value);
  if (typeof value === "boolean" || typeof value === "number") return String(value);
  if (Array.isArray(value)) return `[${value.map((item) => inline(item)).join(", ")}]`;
  return `{ ${entries(value).map(([name, item]) => `${key(name)} = ${inline(item)}`).join(", ")} }`;
}

function entries(table) {
  return Object.entries(table).filter(([, value]) => value !== undefined && value !== null);
}

/** One line, or one item a line where the value is a list of tables. */
function line(name, value) {
  const tables = Array.isArray(value) && value.length > 0 && value.every((item) => typeof item === "object" && !Array.isArray(item));
  if (!tables) return `${key(name)} = ${inline(value)}`;
  return [`${key(name)} = [`, ...value.map((item) => `    ${inline(item)},`), "]"].join("\n");
}

/** An object of sections as TOML text. */
export function writeToml(input) {
  const isTable = (value) => typeof value === "object" && !Array.isArray(value);
  const isList = (value) => Array.isArray(value) && value.length > 0 && value.every((item) => isTable(item));
  const given = entries(input);
  const table = (head, section) => [head, ...entries(section).map(([item, value]) => line(item, value))].join("\n");
  // Keys without a section come first, lists of sections last.
  const own = given.filter(([, value]) => !isTable(value) && !isList(value)).map(([name, value]) => line(name, value)).join("\n");
  const sections = given.filter(([, value]) => isTable(value) && entries(value).length > 0).map(([name, section]) => table(`[${key(name)}]`, section));
  const lists = given.filter(([, value]) => isList(value)).flatMap(([name, list]) => list.map((section) => table(`[[${key(name)}]]`, section)));
  return [own, ...sections, ...lists].filter(Boolean).join("\n\n").concat("\n");
}
