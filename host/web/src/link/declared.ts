// The parts of the generated module schema.ts: described enums, messages that pack and unpack, the parameter table.

import { crc16 } from "./crc";

export type Kind = "u8" | "i8" | "u16" | "i16" | "u32" | "i32";

const WIDTHS: Record<Kind, number> = { u8: 1, i8: 1, u16: 2, i16: 2, u32: 4, i32: 4 };

function read(view: DataView, kind: Kind, at: number): number {
  switch (kind) {
    case "u8": return view.getUint8(at);
    case "i8": return view.getInt8(at);
    case "u16": return view.getUint16(at, true);
    case "i16": return view.getInt16(at, true);
    case "u32": return view.getUint32(at, true);
    case "i32": return view.getInt32(at, true);
  }
}

function write(view: DataView, kind: Kind, at: number, value: number): void {
  switch (kind) {
    case "u8": return view.setUint8(at, value);
    case "i8": return view.setInt8(at, value);
    case "u16": return view.setUint16(at, value, true);
    case "i16": return view.setInt16(at, value, true);
    case "u32": return view.setUint32(at, value, true);
    case "i32": return view.setInt32(at, value, true);
  }
}

function put(view: DataView, kind: Kind, at: number, value: number, name: string): void {
  write(view, kind, at, value);
  if (read(view, kind, at) !== value) {
    throw new LinkError(`${name} is ${value}, which does not fit ${kind}; choose a value that does.`);
  }
}

function viewOf(bytes: Uint8Array): DataView {
  return new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
}

/** One sentence: what is wrong on the link, where, and what to do. */
export class LinkError extends Error {}

/** The board understood a request and said no; `code` is a value of NackCode. */
export class RefusedError extends LinkError {
  constructor(sentence: string, readonly code: number) {
    super(sentence);
  }
}

export type Word = {
  readonly value: number;
  readonly name: string;
  readonly description: string;
  readonly remedy: string;
  readonly detail: string;
};

type Spelled = readonly [value: number, description: string, remedy?: string, detail?: string];

/** The values of one list of shared/link/enums.toml, by name in `is` and by number with `of`. */
export class Enumeration<Name extends string> {
  readonly is: Readonly<Record<Name, number>>;
  private readonly words = new Map<number, Word>();

  constructor(readonly title: string, entries: Readonly<Record<Name, Spelled>>) {
    const numbers: Partial<Record<Name, number>> = {};
    for (const name of Object.keys(entries) as Name[]) {
      const [value, description, remedy = "", detail = ""] = entries[name];
      numbers[name] = value;
      this.words.set(value, { value, name, description, remedy, detail });
    }
    this.is = numbers as Record<Name, number>;
  }

  /** The meaning of a received number; a number of another firmware is named as such. */
  of(value: number): Word {
    return this.words.get(value) ?? {
      value,
      name: `${this.title} ${value}`,
      description: "a value that this page does not know",
      remedy: "Flash the firmware that belongs to this page with `greywhale flash`.",
      detail: "",
    };
  }
}

type FieldSpec = readonly [name: string, kind: Kind, count?: number, lsb?: number];
type Payload = Readonly<Record<string, number | readonly number[]>>;

/** One payload in one direction; `Values` is the type of what it carries. */
export class Message<Values extends object> {
  readonly size: number;
  private readonly places: readonly { name: string; kind: Kind; count: number; at: number; lsb: number }[];

  constructor(readonly name: string, readonly type: number, fields: readonly FieldSpec[]) {
    let at = 0;
    this.places = fields.map(([field, kind, count = 0, lsb = 1]) => {
      const place = { name: field, kind, count, at, lsb };
      at += WIDTHS[kind] * (count || 1);
      return place;
    });
    this.size = at;
  }

  /** Offset in bytes and physical size of one count of a field. */
  place(name: keyof Values & string): { at: number; lsb: number } {
    const found = this.places.find((place) => place.name === name);
    if (!found) throw new LinkError(`${this.name} has no field ${name}; read docs/link.md.`);
    return found;
  }

  pack(values: Values): Uint8Array {
    const payload = new Uint8Array(this.size);
    const view = viewOf(payload);
    const given = values as unknown as Payload;
    for (const { name, kind, count, at } of this.places) {
      const value = given[name];
      const list = typeof value === "number" ? [value] : (value ?? []);
      if (list.length !== (count || 1)) {
        throw new LinkError(`${this.name}.${name} has ${list.length} values; give ${count || 1}.`);
      }
      list.forEach((one, i) => put(view, kind, at + i * WIDTHS[kind], one, `${this.name}.${name}`));
    }
    return payload;
  }

  unpack(payload: Uint8Array): Values {
    if (payload.length !== this.size) {
      throw new LinkError(
        `The board sent ${payload.length} bytes as ${this.name}, but this page expects ${this.size}: ` +
          "flash the firmware that belongs to it with `greywhale flash`.",
      );
    }
    const view = viewOf(payload);
    const values: Record<string, number | readonly number[]> = {};
    for (const { name, kind, count, at } of this.places) {
      values[name] = count
        ? Array.from({ length: count }, (_, i) => read(view, kind, at + i * WIDTHS[kind]))
        : read(view, kind, at);
    }
    return values as unknown as Values;
  }
}

/** A message that is answered. */
export class Request<Values extends object, Reply extends object> extends Message<Values> {
  constructor(name: string, type: number, fields: readonly FieldSpec[], readonly reply: () => Message<Reply>) {
    super(name, type, fields);
  }
}

type ParameterSpec = readonly [
  name: string, kind: Kind, unit: string, lsb: number, minimum: number, maximum: number,
  defaults: readonly number[], nonzero: boolean, below: string | null, description: string,
];

/** One entry of the table: "joint2.kp". minimum, maximum and initial are raw; physical value = raw x lsb. */
export type Parameter = {
  readonly index: number;
  readonly name: string;
  readonly kind: Kind;
  readonly unit: string;
  readonly lsb: number;
  readonly minimum: number;
  readonly maximum: number;
  readonly initial: number;
  readonly nonzero: boolean;
  readonly below: string | null;
  readonly description: string;
  readonly since: number; // the first layout that has it
};

/** All parameters in the order of their flat index, and their packed form. */
export class Table {
  readonly parameters: readonly Parameter[];
  private readonly byName: ReadonlyMap<string, Parameter>;

  constructor(groups: readonly (readonly [name: string, count: number, fields: readonly ParameterSpec[], since?: number])[]) {
    const all: Parameter[] = [];
    for (const [group, count, fields, since = 1] of groups) {
      for (let element = 0; element < count; element++) {
        const prefix = group ? `${group}${element}.` : "";
        for (const [name, kind, unit, lsb, minimum, maximum, defaults, nonzero, below, description] of fields) {
          all.push({
            index: all.length, name: prefix + name, kind, unit, lsb, minimum, maximum,
            initial: defaults[element] ?? 0, nonzero, below: below && prefix + below, description, since,
          });
        }
      }
    }
    this.parameters = all;
    this.byName = new Map(all.map((parameter) => [parameter.name, parameter]));
  }

  named(name: string): Parameter {
    const found = this.byName.get(name);
    if (!found) throw new LinkError(`There is no parameter ${name}; docs/link.md lists them.`);
    return found;
  }

  /** The whole table, raw values in index order, as it lies in RAM and EEPROM. */
  pack(raw: readonly number[]): Uint8Array {
    const bytes = new Uint8Array(this.parameters.reduce((sum, { kind }) => sum + WIDTHS[kind], 0));
    const view = viewOf(bytes);
    let at = 0;
    for (const { index, kind, name } of this.parameters) {
      put(view, kind, at, raw[index] ?? NaN, name);
      at += WIDTHS[kind];
    }
    return bytes;
  }

  /** The CRC that the board computes over the same set. */
  crc(raw: readonly number[]): number {
    return crc16(this.pack(raw));
  }
}
