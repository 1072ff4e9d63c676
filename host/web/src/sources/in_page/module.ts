// The bench as WebAssembly (sim/web/exports.cpp): firmware, arm, potentiometers, hands. It knows no clock and no page.

import { startCode, type Exports } from "../../parts/web_assembly";
import type { Call } from "./messages";

export const TICK_SLICES = 4; // of 250 us
const SEED = 1; // of the noise
const NUMBERS = 256;
const BYTES = 4096;
const LEADER_AT = 12; // of what `look` shows

export class BenchModule {
  private constructor(private readonly exports: Exports) {
    this.call("_initialize");
  }

  /** A bench with this arm, its power off. */
  static async load(code: BufferSource, arm: readonly number[]): Promise<BenchModule> {
    const module = new BenchModule(await startCode(code, "the simulated bench"));
    module.numbers().set(arm);
    module.call("start", SEED);
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
    return new Uint8Array(this.exports.memory.buffer, this.call("bytes"), BYTES);
  }

  /** The board's EEPROM itself. */
  eeprom(): Uint8Array {
    return new Uint8Array(this.exports.memory.buffer, this.call("eeprom"), this.call("eeprom_size"));
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

  /** The angles of the leader arm, rad. */
  leader(): number[] {
    this.call("look");
    return Array.from(this.numbers().subarray(LEADER_AT, LEADER_AT + 4));
  }
}
