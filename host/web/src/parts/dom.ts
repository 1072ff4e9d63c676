// Builds elements. Whatever is shown is set as text, never read as HTML.

import { namedText, type NamedText } from "./named_text";

type Props = {
  readonly class?: string;
  readonly title?: string;
  readonly type?: string;
  readonly value?: string;
  readonly href?: string;
  readonly disabled?: boolean;
  readonly checked?: boolean;
  readonly hidden?: boolean;
  /** Any other attribute, such as aria-label or role. */
  readonly attrs?: Readonly<Record<string, string>>;
  readonly on?: Readonly<Record<string, (event: Event) => void>>;
};

export function el<Tag extends keyof HTMLElementTagNameMap>(
  tag: Tag, props: Props = {}, ...children: (Node | string)[]
): HTMLElementTagNameMap[Tag] {
  const element = document.createElement(tag);
  const { class: classes, attrs = {}, on = {}, ...direct } = props;
  if (classes) element.className = classes;
  for (const [name, value] of Object.entries(attrs)) element.setAttribute(name, value);
  for (const [name, listener] of Object.entries(on)) element.addEventListener(name, listener);
  Object.assign(element, direct);
  element.append(...children);
  return element;
}

export function button(label: string, act: () => void, props: Props = {}): HTMLButtonElement {
  return el("button", { type: "button", ...props, on: { click: act, ...props.on } }, label);
}

/** A choice from a list of values with their labels; `chosen` hears each new one. */
export function select<Value extends string>(
  label: string, values: readonly (readonly [Value, string])[], chosen: (value: Value) => void,
): HTMLSelectElement {
  const box = el("select", { attrs: { "aria-label": label } });
  box.append(...values.map(([value, text]) => el("option", { value }, text)));
  box.addEventListener("change", () => chosen(box.value as Value));
  return box;
}

/** The head of a table: the title of each column, or a cell that has it. */
export function tableHead(...titles: (string | HTMLElement)[]): HTMLElement {
  const cells = titles.map((title) => (typeof title === "string" ? el("th", { attrs: { scope: "col" } }, title) : title));
  return el("thead", {}, el("tr", {}, ...cells));
}

/** Hears a pointer that is pressed on an element, then each of its moves until it is let go, also beyond the element. */
export function onDrag(
  element: GlobalEventHandlers & Element, pressed: (event: PointerEvent) => void, dragged: (event: PointerEvent) => void = pressed,
): void {
  element.addEventListener("pointerdown", (event) => {
    element.setPointerCapture(event.pointerId);
    pressed(event);
  });
  element.addEventListener("pointermove", (event) => {
    if (element.hasPointerCapture(event.pointerId)) dragged(event);
  });
}

const SVG = "http://www.w3.org/2000/svg";

export function svg<Tag extends keyof SVGElementTagNameMap>(
  tag: Tag, attrs: Readonly<Record<string, string | number>> = {}, ...children: (Node | string)[]
): SVGElementTagNameMap[Tag] {
  const element = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attrs)) element.setAttribute(name, String(value));
  element.append(...children);
  return element;
}

/** Sets a text only where it differs, so that nothing is laid out or read aloud anew. */
export function setText(node: Node, text: string): void {
  if (node.textContent !== text) node.textContent = text;
}

/** A labelled field for a text file; `chosen` hears at once of each one that a person gives, null while there is none. */
export function fileField(label: string, ending: string, chosen: (file: Promise<NamedText> | null) => void): HTMLLabelElement {
  const input = el("input", { type: "file", attrs: { accept: ending } });
  input.addEventListener("click", () => { // so that the same file, mended, is taken again
    input.value = "";
    chosen(null);
  });
  input.addEventListener("change", () => {
    const [file] = input.files ?? [];
    chosen(file ? file.arrayBuffer().then((bytes) => namedText(file.name, new Uint8Array(bytes))) : null);
  });
  return el("label", { class: "file" }, el("span", {}, label), input);
}

/** Hands a text to the browser as a file to keep. */
export function download(name: string, text: string, type = "text/csv"): void {
  const address = URL.createObjectURL(new Blob([text], { type }));
  el("a", { href: address, attrs: { download: name } }).click();
  URL.revokeObjectURL(address);
}
