// The bench as WebAssembly (sim/web/exports.cpp): firmware, arm, potentiometers, hands. It knows no clock and no page.

import type { Call } from "./messages";

export const TICK_SLICES = 4; // of 250 us
const SEED = 1; // of the noise
const NUMBERS = 256;
const BYTES = 4096;
const LEADER_AT = 12; // of what `look` shows

type Exports = { readonly memory: WebAssembly.Memory } & Readonly<Record<string, (...given: number[]) => number>>;

export class BenchModule {
  private readonly exports: Exports;

  private constructor(instance: WebAssembly.Instance) {
    this.exports = instance.exports as unknown as Exports;
    this.call("_initialize");
  }

  /** A bench with this arm, its power off. */
  static async load(code: BufferSource, arm: readonly number[]): Promise<BenchModule> {
    const refuse = (): never => {
      throw new Error("the bench asked for a file");
    };
    const files = { fd_close: refuse, fd_seek: refuse, fd_write: refuse };
    const { instance } = await WebAssembly.instantiate(code, { wasi_snapshot_preview1: files });
    const module = new BenchModule(instance);
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

  /** Where the leader arm is, rad. */
  leader(): number[] {
    this.call("look");
    return Array.from(this.numbers().subarray(LEADER_AT, LEADER_AT + 4));
  }
}
