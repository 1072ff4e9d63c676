// Types of the generated rules for files.

/** A JSON Schema as far as the host's have it. */
export type Schema = {
  readonly type: string;
  readonly enum?: readonly (string | number)[]; // the values there are
  readonly minimum?: number;
  readonly exclusiveMinimum?: number;
  readonly maximum?: number;
  readonly minItems?: number; // the largest number too
  readonly maxItems?: number;
  readonly prefixItems?: readonly Schema[]; // as many as there must be
  readonly items?: Schema;
  readonly properties?: Readonly<Record<string, Schema>>; // any, if it has none
  readonly required?: readonly string[];
  readonly default?: string | number | boolean;
  readonly parameter?: string; // that keeps a number: "joint{}.kp", of each joint
  readonly scale?: number; // so many units of the parameter are one of the file's
};

/** A kind of file, who takes it, and keys that only this one has. */
export type FileKind = {
  readonly words: string;
  readonly taker: string;
  readonly inside?: readonly string[];
  readonly inside_ends?: readonly string[];
  readonly top?: readonly string[];
  readonly tables?: readonly string[];
  readonly and_key?: string;
};
