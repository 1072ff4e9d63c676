// A verb's result for people: the sentences and tables that a terminal prints, with pictures and buttons for what comes next.

import { button, el } from "../../parts/dom";
import type { Column, Row, Sentences, Step, Table, Telling } from "../../session/host_types";
import { motionsPicture, type ReadLog } from "./motions_picture";

/** Opens a verb's form with values filled in. */
export type OpenVerb = (verb: string, given: Readonly<Record<string, unknown>>) => void;

/** `pictures` stand before the buttons. */
export function tellingElements({ parts, steps }: Telling, log: ReadLog, open: OpenVerb, pictures: HTMLElement[]): HTMLElement[] {
  const shown = parts.map((part) => {
    if (part.kind === "motions") return motionsPicture(part, log);
    return part.kind === "table" ? tableElement(part) : sentences(part);
  });
  return [...shown.filter((one) => one !== null), ...pictures, ...(steps.length ? [nextSteps(steps, open)] : [])];
}

function sentences({ lines, title, listed, grave }: Sentences): HTMLElement | null {
  if (!lines.length) return null;
  const texts = listed
    ? [el("ul", {}, ...lines.map((line) => el("li", {}, ...words(line))))]
    : lines.map((line) => el("p", {}, ...words(line)));
  return el("div", grave ? { class: "grave" } : {}, ...heading(title), ...texts);
}

function tableElement({ columns, rows, title }: Table): HTMLElement {
  const heads = columns.some(({ head, unit }) => head || unit)
    ? [el("thead", {}, el("tr", {}, ...columns.map(headCell)))]
    : [];
  const body = el("tbody", {}, ...rows.map((row) => rowElement(row, columns)));
  const named = title || columns.map(({ head }) => head).find((head) => head) || "Table";
  return el("div", {}, ...heading(title),
    el("div", { class: "scroll", attrs: { tabindex: "0", role: "group", "aria-label": named } }, el("table", {}, ...heads, body)));
}

function headCell({ head, unit, left }: Column): HTMLElement {
  if (!head && !unit) return el("td");
  const words = [head.trim(), ...(unit ? [" ", el("span", { class: "unit" }, unit)] : [])];
  return el("th", { class: left ? "words" : "", attrs: { scope: "col" } }, ...words);
}

function rowElement({ cells, remark, below }: Row, columns: readonly Column[]): HTMLElement {
  const [name = "", ...values] = cells;
  if (!values.length) {
    return el("tr", {}, el("th", { class: "heading", attrs: { scope: "rowgroup", colspan: String(columns.length) } }, name));
  }
  const shown = values.map((value, number) => el("td", { class: columns[number + 1]?.left ? "words" : "" }, ...words(value)));
  if (below) shown.at(-1)!.append(el("p", { class: "below" }, ...words(below)));
  const left = columns.length - cells.length; // columns in which the row has nothing
  if (remark) shown.push(el("td", { class: "words remark", attrs: { colspan: String(left + 1) } }, remark));
  else if (left) shown.push(el("td", { attrs: { colspan: String(left) } }));
  return el("tr", {}, el("th", { attrs: { scope: "row", "data-says": name } }, name), ...shown);
}

function nextSteps(steps: readonly Step[], open: OpenVerb): HTMLElement {
  return el("div", { class: "row next", attrs: { role: "group", "aria-label": "Next" } },
    el("span", { class: "quiet" }, "Next:"),
    ...steps.map(({ verb, words: said, given }, number) =>
      button(said, () => open(verb, given), { class: number ? "" : "primary", title: `Open ${verb} with this filled in` })));
}

function heading(title: string): HTMLElement[] {
  return title ? [el("h3", {}, title)] : [];
}

/** Text whose `commands` stand out, and whose arrows are arrows. */
function words(text: string): (Node | string)[] {
  return text.split("`").map((piece, number) => (number % 2 ? el("code", {}, piece) : piece.replaceAll(" -> ", " → ")));
}
