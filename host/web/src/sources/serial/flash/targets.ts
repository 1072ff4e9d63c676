// A board that can be flashed.

import { Board } from "../../../link/schema";

export type Target = {
  readonly name: string;
  readonly identity: number; // of Board
  readonly language: number; // the version of STK500 that its bootloader speaks
  readonly bauds: readonly number[];
  readonly signature: string; // of the chip, in hexadecimal
  readonly page: number; // bytes that the bootloader writes at once
  readonly space: number; // bytes that the bootloader leaves
};

export function titleOf({ identity }: Target): string {
  return Board.of(identity).description;
}
