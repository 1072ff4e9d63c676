// A file's size and date in words, and a name that is free.

const DATE = new Intl.DateTimeFormat("en-GB", { day: "numeric", month: "short", year: "numeric", hour: "2-digit", minute: "2-digit" });
const STEP = 1000;
const UNITS = ["B", "kB", "MB", "GB"];

/** Such as 1.2 MB, 29 Nov 2026, 15:20. */
export function fileWords(file: { readonly size_bytes: number; readonly changed_s: number }): string {
  return `${sizeWords(file.size_bytes)}, ${DATE.format(file.changed_s * 1000)}`;
}

/** This name, or the next that no file has: name-2, name-3, ... */
export function freeName(name: string, files: readonly { readonly name: string }[]): string {
  const taken = new Set(files.map((file) => file.name));
  const [, stem = "", end = ""] = /^(.*?)(\.[^.]*)?$/.exec(name) ?? [];
  let free = name;
  for (let number = 2; taken.has(free); number++) free = `${stem}-${number}${end}`;
  return free;
}

export function sizeWords(bytes: number): string {
  let size = bytes;
  let unit = 0;
  while (size >= STEP && unit < UNITS.length - 1) {
    size /= STEP;
    unit++;
  }
  return `${unit && size < 10 ? size.toFixed(1) : Math.round(size)} ${UNITS[unit]!}`;
}
