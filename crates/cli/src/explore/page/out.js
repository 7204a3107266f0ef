// What leaves the page: the command line, the scene file, the lines of Python, numbers as CSV, files.

/** A word for a shell, quoted where it needs to be. */
function shellWord(text) {
  return /^[A-Za-z0-9_@%+=:,./-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`;
}

const OWN_TEXT = "system.toml";

/** Texts that are given where others give a file are that file for a shell. */
function fileOf(name, value) {
  if (typeof value !== "string" || !value.includes("\n")) return null;
  return { system: OWN_TEXT, law: "law.toml", ensemble: "fit.json" }[name] ?? null;
}

function valuesOf(options) {
  const all = [];
  for (const [name, value] of Object.entries(options)) {
    if (value === null || value === undefined || value === false || name === "plot") continue;
    const draws = name === "ensemble" ? (/\n:(\d+)$/.exec(value)?.[1] ?? null) : null;
    const file = fileOf(name, value);
    all.push([name, file ? file + (draws ? `:${draws}` : "") : value]);
  }
  return all;
}

/** The command line that gives the same numbers. */
export function commandLine(command, options) {
  const words = ["twinslip", command];
  if (options.of) words.push(options.of);
  for (const [name, value] of valuesOf(options)) {
    if (name === "of") continue;
    const flag = `--${name.replaceAll("_", "-")}`;
    for (const one of [value].flat()) {
      if (one === true) words.push(flag);
      else if (String(one).startsWith("-")) words.push(shellWord(`${flag}=${one}`));
      else words.push(flag, shellWord(String(one)));
    }
  }
  return words.join(" ");
}

/** The files that the command line names and that are texts here: pairs of name and text. */
export function filesOf(options) {
  const all = [];
  for (const [name, value] of Object.entries(options)) {
    const file = fileOf(name, value);
    if (file) all.push([file, name === "ensemble" ? value.replace(/\n:\d+$/, "\n") : value]);
  }
  return all;
}

function tomlValue(value) {
  if (typeof value === "number") return Number.isInteger(value) ? value.toFixed(1) : String(value);
  return typeof value === "boolean" ? String(value) : JSON.stringify(value);
}

/** The scene file for `twinslip run`. */
export function toml(command, options) {
  const lines = [`command = "${command}"`];
  for (const [name, value] of valuesOf(options)) {
    const key = name.replaceAll("_", "-");
    if (name === "set") {
      const pairs = [value].flat().map((text) => {
        const [parameter, ...rest] = text.split("=");
        return `${parameter.trim()} = ${tomlValue(Number(rest.join("=")))}`;
      });
      lines.push(`set = { ${pairs.join(", ")} }`);
    } else if (["returns", "skip", "interfaces", "points"].includes(name)) lines.push(`${key} = ${value}`);
    else if (Array.isArray(value)) lines.push(`${key} = [${value.map(tomlValue).join(", ")}]`);
    else lines.push(`${key} = ${tomlValue(value)}`);
  }
  return `${lines.join("\n")}\n`;
}

function pythonValue(value) {
  if (value === true) return "True";
  if (Array.isArray(value)) return `[${value.map(pythonValue).join(", ")}]`;
  return typeof value === "number" ? String(value) : JSON.stringify(value);
}

/** The lines of Python that give the same numbers; `model` are the names of the options that a System takes. */
export function python(command, options, model) {
  const system = [];
  const own = [];
  for (const [name, value] of valuesOf(options)) {
    if (name === "set") {
      for (const text of [value].flat()) {
        const [parameter, ...rest] = text.split("=");
        system.push(`${parameter.trim()}=${rest.join("=")}`);
      }
    } else if (name === "of") own.unshift(pythonValue(value));
    else if (model.includes(name)) system.push(`${name}=${pythonValue(value)}`);
    else own.push(`${name === "in" || name === "from" ? `${name}_` : name}=${pythonValue(value)}`);
  }
  return `import twinslip\n\nsystem = twinslip.System(${system.join(", ")})\nresult = system.${command}(${own.join(", ")})\nprint(result)\n`;
}

/** Rows as CSV, below the command that gives them. */
export function csv(answer) {
  const cell = (x) => {
    if (x === null || x === undefined) return "";
    const text = String(x);
    return /[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
  };
  const lines = [`# ${commandLine(answer.command, answer.options)}`];
  const units = answer.columns.map((name, i) => (answer.units[i] ? `${name} [${answer.units[i]}]` : null)).filter(Boolean);
  if (units.length) lines.push(`# units: ${units.join(", ")}`);
  lines.push(answer.columns.map(cell).join(","));
  for (const row of answer.rows) lines.push(row.map(cell).join(","));
  return `${lines.join("\n")}\n`;
}

/** Hands the browser a file to keep. */
export function download(name, content, type) {
  const blob = content instanceof Blob ? content : new Blob([content], { type });
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

/** Puts a text on the clipboard; whether that was allowed. */
export async function copied(text) {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    return false;
  }
}
