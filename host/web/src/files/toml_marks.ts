// Refuses what smol-toml takes and the host's reader does not: TOML 1.1, and what would keep a parser busy.

import { DEEPEST_LEVEL, tooDeep } from "./rules";

// Strings and comments as a whole, so that nothing in them counts, and all else one by one.
const TOKEN = /(?<part>"{3}(?:[^\\]|\\.)*?"{3}|'{3}.*?'{3}|"(?:[^"\\\n]|\\.)*"|'[^'\n]*'|[\p{L}\p{N}_]+|-+|[^\S\n]+)|#[^\n]*|./gsu;

/** Something that the host refuses, in which line it stands, and whether its words are the host's whole sentence. */
export type Mark = { readonly line: number; readonly words: string; readonly deep: boolean };

export function findMark(text: string): Mark | null {
  const open: string[] = [];
  let parts = 0;
  let before = ""; // what is no space
  const mark = (at: number, words: string, deep = false): Mark => ({ line: text.slice(0, at).split("\n").length, words, deep });
  for (const found of text.matchAll(TOKEN)) {
    const [token] = found;
    const isPart = found.groups!["part"] !== undefined;
    if (isPart && token.startsWith('"') && [...token.matchAll(/\\(.)/gs)].some(([, letter]) => "ex".includes(letter!))) {
      return mark(found.index, "an escape of TOML 1.1");
    }
    if (open.at(-1) === "{" && (token === "\n" || (token === "}" && before === ","))) {
      return mark(found.index, "an inline table goes over lines, or ends with a comma");
    }
    if (token === "[" || token === "{") open.push(token);
    else if (token === "]" || token === "}") open.pop();
    else if (token === ".") parts++;
    if (!isPart && token !== ".") parts = 0;
    if (open.length > DEEPEST_LEVEL || parts > DEEPEST_LEVEL) return mark(found.index, tooDeep({ most: DEEPEST_LEVEL }), true);
    if (token.trim() && !token.startsWith("#")) before = token;
  }
  return null;
}
