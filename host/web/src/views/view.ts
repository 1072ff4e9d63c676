// The interface of a view: its element, and when to draw.

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
