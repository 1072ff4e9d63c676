// The data that the tuner gets of greywhale (tools/site/tuner_data.py writes it), and the messages of the page and its worker.

import type { ArmNumbers } from "../files/arm_file";
import type { Prediction, Tuned } from "../session/services";

/** The course of a search so far: the best cost of each joint, now and after each batch. */
export type Found = {
  readonly best: Controllers;
  readonly cost: readonly number[];
  readonly evaluations: number;
  readonly curve: readonly (readonly [evaluations: number, cost: readonly number[]])[];
};

/** One joint's settings in raw values, in the order of the parameter table. */
export type Row = readonly number[];
export type Controllers = readonly Row[]; // of four joints

export type Noise = { readonly seeds: readonly [number, number]; readonly gaps: readonly number[] };

/** A motion: of each joint its steps from row to row; after each 0 comes how many there are. */
export type Steps = readonly (readonly number[])[];

export type Drill = {
  readonly name: string;
  readonly steps: Steps;
  readonly searching: Noise;
  readonly judging: Noise;
  readonly moving: readonly (readonly [number, number])[] | null; // ticks; null: all weigh the same
  readonly total_weight: number;
  readonly importance: number;
  readonly first_block: number; // of rattle, after the wait
  readonly floor: readonly number[]; // rad
};

export type Rests = {
  readonly steps: Steps;
  readonly noise: Noise;
  readonly ticks: readonly (readonly [number, number])[];
  readonly variants: readonly (readonly number[])[]; // the arm in each scenario
  readonly band: number; // rad
  readonly turns: number; // so many are hunting
};

/** A searched number; `mirror` is another column that gets the same size with the other sign. */
export type Variable = {
  readonly column: number;
  readonly mirror: number | null;
  readonly unit: number;
  readonly sign: number;
  readonly is_set: boolean;
  readonly logarithmic: boolean;
  readonly offset: number;
  readonly bounds: readonly [number, number];
};

export type Stage = {
  readonly name: string;
  readonly share: number;
  readonly sigma: number | null;
  readonly space: "whole" | "reduced";
  readonly groups: readonly (readonly number[])[]; // of joints that search at the same time
  readonly random: readonly (readonly [string, string])[]; // a generator's state and increment for each joint
};

export type SearchData = {
  readonly budget: number;
  readonly pack: number;
  readonly a: number;
  readonly weights: readonly number[];
  readonly keep: number;
  readonly stages: readonly Stage[];
  readonly spaces: Readonly<Record<"whole" | "reduced", readonly Variable[]>>;
  readonly calmer: readonly (readonly [ku: number, ki: number])[]; // shares of what was found
  readonly ku: number; // columns
  readonly ki: number;
  readonly least_width: number;
  readonly set_unit: number;
  readonly stretch: readonly { readonly column: number; readonly raw: number; readonly sets: readonly number[] }[];
};

export type TunerData = {
  readonly settings: readonly number[];
  readonly timing: readonly [prompt: readonly number[], late: readonly number[]];
  readonly leader_pots: readonly number[];
  readonly follower_pots: readonly number[];
  readonly motion: { readonly scale: number; readonly apart: number; readonly wait_s: number; readonly soon_s: number };
  readonly plant: readonly number[];
  readonly drills: readonly Drill[];
  readonly shown: number; // the drill that a person sees
  /** Longer after the first stage of a search. */
  readonly rests: { readonly searching: Rests; readonly refining: Rests; readonly judging: Rests };
  readonly limits: readonly number[]; // in the order of Limits in host/native/web/score.cpp
  readonly search: SearchData;
  readonly predicted: PredictionData;
};

/** An arm without noise, and how its leader moves in a prediction. */
export type PredictionData = {
  readonly plant: readonly number[];
  readonly leader_pots: readonly number[];
  readonly follower_pots: readonly number[];
  readonly motions: { readonly [motion in keyof Prediction]: Steps };
  readonly noise: Noise;
  readonly wait_s: number;
  readonly every: number; // ticks between two rows
  readonly pwm_tops: Readonly<Record<string, readonly number[]>>; // of each board, by its number
};

export type ToTuner =
  | { kind: "begin"; code: ArrayBuffer; data: TunerData } // first
  | { kind: "tune"; before: Controllers }
  | { kind: "stop" }
  | { kind: "predict"; id: number; raw: readonly number[]; board: number; arm: ArmNumbers | null }; // null: the default one

export type FromTuner =
  | { kind: "searched"; evaluations: number; budget: number; cost: readonly number[]; curve: Found["curve"] }
  | { kind: "tuned"; tuned: Tuned }
  | { kind: "predicted"; id: number; prediction: Prediction }
  | { kind: "failed"; sentence: string };
