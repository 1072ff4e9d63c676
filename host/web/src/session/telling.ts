// A result of a verb for people, of which a terminal of the host makes text.

/** A new line in a head is where a terminal breaks it. */
export type Column = { readonly head: string; readonly unit: string; readonly left: boolean };

/** A single cell is the heading of the rows below it. */
export type Row = { readonly cells: readonly string[]; readonly remark: string; readonly below: string };

export type Sentences = {
  readonly kind: "sentences";
  readonly lines: readonly string[];
  readonly title: string;
  readonly listed: boolean;
  readonly grave: boolean;
};

export type Table = {
  readonly kind: "table";
  readonly columns: readonly Column[];
  readonly rows: readonly Row[];
  readonly title: string;
};

/** Logs to draw over each other: name to file. */
export type Motions = { readonly kind: "motions"; readonly logs: Readonly<Record<string, string>>; readonly title: string };

/** A verb that may come next, with values of its arguments. */
export type Step = { readonly verb: string; readonly words: string; readonly given: Readonly<Record<string, unknown>> };

export type Telling = { readonly parts: readonly (Sentences | Table | Motions)[]; readonly steps: readonly Step[] };
