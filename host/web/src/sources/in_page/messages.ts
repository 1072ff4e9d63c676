// Messages between the page and the worker with its bench, and the parts of a bench.

import type { ArmDescription, BenchControls, BenchWish, HandsWish, NamedMotion, Range } from "../../session/services";

/** A call of the module: its export's name, and numbers. */
export type Call = readonly [name: string, ...given: number[]];

/** A program and the first address of its bytes, which are in base64. */
export type Program = { readonly address: number; readonly bytes: string };

/** Poses of the leader in rad, so many a second. */
export type Motion = NamedMotion & { readonly hz: number; readonly rows: readonly (readonly number[])[] };

/** As tools/site writes it: the board, the arm, its mistakes, a person's motions. */
export type BenchData = {
  readonly bootloader: Program;
  readonly numbers: readonly number[]; // of the board's wires and of the arm, as the module takes them
  readonly description: ArmDescription;
  readonly leader: BenchControls["leader"];
  readonly supply: Range;
  readonly load: Range;
  readonly noise: Range; // times the arm's own
  readonly play: Range;
  readonly faults: readonly {
    readonly name: string;
    readonly group: string;
    readonly title: string;
    readonly description: string;
    readonly places: Readonly<Record<string, readonly Call[]>>; // "" for a fault without a place
  }[];
  /** The first one is what the leader does until a person leads. */
  readonly motions: readonly Motion[];
};

export type ToBench =
  | { kind: "start"; code: ArrayBuffer; data: BenchData; firmware: Uint8Array; eeprom: Uint8Array | null }
  | { kind: "send"; data: Uint8Array; flashes: boolean } // to a bootloader, or frames to the firmware
  | { kind: "reset" } // the board's reset line
  | { kind: "wish"; id: number; wish: BenchWish | HandsWish }
  | { kind: "visible"; on: boolean } // time stands still for a page that nobody sees
  | { kind: "taken"; count: number }; // so many bytes are worked off

export type FromBench =
  | { kind: "ready" }
  | { kind: "bytes"; data: Uint8Array }
  | { kind: "restarted" }
  | { kind: "eeprom"; content: Uint8Array }
  | { kind: "done"; id: number; error: string | null; takes_s: number } // until hands are there
  | { kind: "failed"; sentence: string };
