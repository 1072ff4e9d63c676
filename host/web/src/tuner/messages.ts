// What the page and the worker with its tuner say to each other.

import type { Searched, Tuned } from "../host";
import type { TunerData } from "./data";
import type { Controllers } from "./module";

export type ToTuner =
  | { kind: "tune"; code: ArrayBuffer; data: TunerData; before: Controllers }
  | { kind: "stop" };

export type FromTuner =
  | { kind: "searched"; searched: Searched }
  | { kind: "tuned"; tuned: Tuned }
  | { kind: "failed"; sentence: string };
