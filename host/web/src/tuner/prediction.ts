// The closed loop with controllers that nobody has uploaded yet: a step and a reach, as the host predicts them.

import type { ArmNumbers } from "../files/arm_file";
import { TABLE } from "../link/schema";
import type { Predicted, Prediction } from "../session/services";
import type { PredictionData, Row } from "./data";
import { ALL, type TunerModule } from "./module";
import { SETTING_NAMES } from "../session/law";

const BEYOND_RAD = 10; // stands for a motion that leaves the range of numbers
const UNKNOWN_BOARD = "1"; // counts as a Mega

type Experiments = { readonly [motion in keyof Prediction]: number };

export class Foresight {
  private readonly experiments = new Map<string, Experiments>(); // by settings and arm

  constructor(private readonly module: TunerModule, private readonly data: PredictionData) {}

  /** The follower under a whole parameter set, wired and calibrated rightly; without an arm the default one. */
  predict(raw: readonly number[], board: number, arm: ArmNumbers | null): Prediction {
    const settings = settingsOf(raw, this.data.pwm_tops[board] ?? this.data.pwm_tops[UNKNOWN_BOARD]!);
    const { step, reach } = this.experimentsWith(settings, arm);
    const controllers = ALL.map((joint) => SETTING_NAMES.map((name) => raw[TABLE.named(`joint${joint}.${name}`).index]!));
    return { step: this.follow(step, controllers), reach: this.follow(reach, controllers) };
  }

  /** A person drags controllers, and settings seldom change: so the module keeps few experiments. */
  private experimentsWith(settings: readonly number[], arm: ArmNumbers | null): Experiments {
    const key = JSON.stringify([settings, arm]);
    const found = this.experiments.get(key);
    if (found) return found;
    const { module, data } = this;
    const quiet = arm ? { ...arm, plant: module.plantOf(arm.arm) } : data;
    const { step, reach } = data.motions;
    const added = { step: module.addMotion(step, settings, quiet), reach: module.addMotion(reach, settings, quiet) };
    this.experiments.set(key, added);
    return added;
  }

  private follow(experiment: number, controllers: readonly Row[]): Predicted {
    const { module, data: { every } } = this;
    module.run(experiment, [controllers]);
    const { leader, follower } = module.trace(experiment, 0, every);
    return {
      time_s: leader.map((_, row) => (row * every) / 1000),
      leader,
      follower: follower.map((angles) => angles.map((angle) => (Number.isNaN(angle) ? BEYOND_RAD : angle))),
      mse: module.mse(experiment, 1)[0]!,
    };
  }
}

/** The settings around the law, in the order in which the module takes them. */
function settingsOf(raw: readonly number[], pwmTops: readonly number[]): number[] {
  const given = (name: string): number => raw[TABLE.named(name).index]!;
  const usual = (group: string, name: string): number[] => ALL.map((joint) => TABLE.named(`${group}${joint}.${name}`).initial);
  return [
    given("period_ms"), given("supply_mv"), 0, given("filter_shift"), // no soft start
    ...["limit_min", "limit_max"].flatMap((end) => ALL.map((joint) => given(`joint${joint}.${end}`))),
    ...usual("joint", "motor_sign"), ...pwmTops,
    ...["leader", "follower"].flatMap((side) => ["zero", "scale"].flatMap((name) => usual(side, name))),
  ];
}
