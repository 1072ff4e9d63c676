// The boards that can be flashed, as greywhale/board/flash/targets.py has them.

import { Board } from "../../../link/schema";

export type Speaks = "STK500 version 1" | "STK500 version 2";
export type Dialect = { readonly speaks: Speaks; readonly baud: number };

export type Target = {
  readonly name: string;
  readonly identity: number; // of Board
  readonly dialects: readonly Dialect[];
  readonly signature: string; // of the chip, in hexadecimal
  readonly page: number; // bytes that the bootloader writes at once
  readonly space: number; // bytes that the bootloader leaves
};

// Nanos are sold with two bootloaders that look alike from outside.
export const TARGETS: readonly Target[] = [
  {
    name: "mega", identity: Board.is.mega2560, dialects: [{ speaks: "STK500 version 2", baud: 115_200 }],
    signature: "1e9801", page: 256, space: 253_952,
  },
  {
    name: "nano", identity: Board.is.nano328,
    dialects: [{ speaks: "STK500 version 1", baud: 115_200 }, { speaks: "STK500 version 1", baud: 57_600 }],
    signature: "1e950f", page: 128, space: 30_720,
  },
];

export function titleOf({ identity }: Target): string {
  return Board.of(identity).description;
}
