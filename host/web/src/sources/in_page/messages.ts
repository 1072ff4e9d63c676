// What the page and the worker with its bench say to each other.

import type { BenchWish } from "../../host";
import type { BenchData } from "./bench_data";

export type ToBench =
  | { kind: "start"; code: ArrayBuffer; data: BenchData; eeprom: Uint8Array | null }
  | { kind: "send"; frame: Uint8Array }
  | { kind: "wish"; id: number; wish: BenchWish }
  | { kind: "visible"; on: boolean } // time stands still for a page that nobody sees
  | { kind: "taken"; count: number }; // so many bytes are worked off

export type FromBench =
  | { kind: "ready" }
  | { kind: "bytes"; data: Uint8Array }
  | { kind: "restarted" }
  | { kind: "eeprom"; content: Uint8Array }
  | { kind: "done"; id: number; error: string | null }
  | { kind: "failed"; sentence: string };
