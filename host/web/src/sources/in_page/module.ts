// The bench as WebAssembly (sim/web/exports.cpp): a board with its program, arm, potentiometers, hands. It knows no clock and
// no page.

import { startCode, type Exports } from "../../parts/web_assembly";
import type { Call, Program } from "./messages";

export const TICK_SLICES = 4; // of 250 us
const MEGA = 0;
const NUMBERS = 256;
const ERASED = 0xff;

export class BenchModule {
  private constructor(private readonly exports: Exports) {
    this.call("_initialize");
  }

  /** A bench with these numbers of wires and arm, and a board with its bootloader and firmware, its power off. */
  static async load(code: BufferSource, numbers: readonly number[], bootloader: Program, firmware: Uint8Array): Promise<BenchModule> {
    const module = new BenchModule(await startCode(code, "the simulated bench"));
    module.numbers().set(numbers);
    module.call("start", MEGA);
    module.program(bootloader.address, Uint8Array.from(atob(bootloader.bytes), (letter) => letter.charCodeAt(0)), true);
    module.write(firmware);
    return module;
  }

  call(...[name, ...given]: Call): number {
    return this.exports[name]!(...given);
  }

  // The module's memory may grow and then is another buffer.
  private numbers(): Float64Array {
    return new Float64Array(this.exports.memory.buffer, this.call("numbers"), NUMBERS);
  }

  private bytes(): Uint8Array {
    return new Uint8Array(this.exports.memory.buffer, this.call("bytes"), this.call("bytes_size"));
  }

  private program(address: number, data: Uint8Array, bootloader: boolean): void {
    this.bytes().set(data);
    this.call("program", address, data.length, Number(bootloader));
  }

  /** Writes a firmware from address 0 on, piece by piece, without what is erased memory. */
  private write(memory: Uint8Array): void {
    const most = this.call("bytes_size");
    for (let at = 0; at < memory.length; at += most) {
      const piece = memory.subarray(at, at + most);
      if (piece.some((byte) => byte !== ERASED)) this.program(at, piece, false);
    }
  }

  /** The content of the board's EEPROM. */
  eeprom(): Uint8Array {
    return this.bytes().slice(0, this.call("read_eeprom"));
  }

  /** Gives the board's EEPROM a content, which has its size. */
  setEeprom(content: Uint8Array): void {
    this.bytes().set(content);
    this.call("write_eeprom", content.length);
  }

  /** Lets a tick pass; what the board said, in the module's memory until the next call. */
  tick(): Uint8Array {
    return this.bytes().subarray(0, this.call("run", TICK_SLICES));
  }

  /** Bytes of the host to the board. */
  send(data: Uint8Array): void {
    this.bytes().set(data);
    this.call("send", data.length);
  }

  /** Leads the leader arm to angles in rad. */
  lead(angles: readonly number[]): void {
    this.numbers().set(angles);
    this.call("lead");
  }

  /** Brings both arms into a pose; the seconds that it takes, 0 where nobody can. */
  pose(angles: readonly number[]): number {
    this.numbers().set(angles);
    return this.call("pose");
  }

  /** The angles of the leader arm, rad. */
  leader(): number[] {
    this.call("look");
    return Array.from(this.numbers().subarray(0, 4));
  }
}
