// The interface of a view: its element, and when to draw.

import { el } from "../parts/dom";

export type View = {
  readonly name: string;
  readonly element: HTMLElement;
  /** True if it shows something without a board. */
  readonly withoutBoard?: boolean;
  /** Called when the view comes to the front, before it is drawn. */
  enter?(): void;
  /** Called when another view comes to the front. */
  leave?(): void;
  /** Called once for each picture of the screen while the view is in front. */
  frame?(): void;
  /** Handles a key; true when it was meant for this view. */
  key?(event: KeyboardEvent): boolean;
};

/** A view with something beside it, which is drawn with it. */
export function beside(view: View, other: Pick<View, "element" | "frame">): View {
  return {
    name: view.name,
    element: el("div", { class: "with-side" }, view.element, other.element),
    enter: () => view.enter?.(),
    leave: () => view.leave?.(),
    frame: () => {
      view.frame?.();
      other.frame?.();
    },
    key: (event) => view.key?.(event) ?? false,
  };
}
