// arm.toml and model.toml: an arm of four joints in numbers, as the core of the tuner takes it. The host alone knows whether
// these belong together: a body's inertias, a breakaway above the sliding friction.

import { LinkError } from "../link/declared";
import type { NamedText } from "../parts/named_text";
import { isTable, require } from "./check";
import { ARM } from "./rules";
import type { Schema } from "./schema_types";
import { readToml, refuseOtherKind } from "./toml";
import type { Toml, TomlTable } from "./toml_types";

type Numbers<Names extends string> = { readonly [name in Names]: number };
type Pots = { readonly supply: number; readonly joint: readonly Numbers<"track" | "centre" | "direction" | "linearity" | "play" | "lag">[] };
type Whole = {
  readonly gravity: number;
  readonly motor_equation: string;
  readonly link: readonly (Numbers<"mass" | "length" | "centre"> & { readonly inertia: Numbers<"xx" | "yy" | "zz"> })[];
  readonly tip: Numbers<"mass">;
  readonly joint: readonly {
    readonly motor: Numbers<"inertia" | "resistance" | "torque_constant" | "viscous" | "gear_ratio">;
    readonly friction: Numbers<"coulomb" | "breakaway" | "stribeck_velocity" | "load" | "creep_velocity">;
    readonly gear: Numbers<"half_gap" | "stiffness" | "damping" | "drag">;
    readonly stops: Numbers<"min" | "max">;
    readonly driver: Numbers<"lost_up" | "lost_down">;
  }[];
  readonly drive: Numbers<"supply" | "supply_resistance" | "resistance">;
  readonly leader_pots: Pots;
  readonly follower_pots: Pots;
};

/** Numbers in the order in which the core takes them; its potentiometers have no noise. */
export type ArmNumbers = { readonly arm: readonly number[]; readonly leader_pots: readonly number[]; readonly follower_pots: readonly number[] };

/** The arm of a file, and whether somebody has identified it; an error is the host's sentence. */
export function armIn(file: NamedText): { readonly identified: boolean; readonly numbers: ArmNumbers } {
  const data = readToml(file);
  try {
    refuseFixed(data, file.name);
    require(data, ARM, file.name);
  } catch (error) {
    refuseOtherKind(data, file.name, "arm");
    throw error;
  }
  const arm = whole(data, ARM) as Whole;
  const numbers = { arm: armNumbers(arm), leader_pots: potNumbers(arm.leader_pots), follower_pots: potNumbers(arm.follower_pots) };
  return { identified: isTable(data["identification"]), numbers };
}

function refuseFixed({ joint }: TomlTable, name: string): void {
  const fixed = Array.isArray(joint) ? (joint as readonly Toml[]).findIndex((one) => isTable(one) && one["fixed"] === true) : -1;
  if (fixed >= 0) throw new LinkError(`${name}: joint[${fixed}] is fixed; this page predicts arms of four joints, and greywhale dashboard any.`);
}

/** A sound file's value with all that it leaves to its default. */
function whole(value: Toml | undefined, { properties, items, minItems, default: usual }: Schema): unknown {
  if (properties) {
    const table: TomlTable = isTable(value) ? value : {};
    return Object.fromEntries(Object.entries(properties).map(([key, inside]) => [key, whole(table[key], inside)]));
  }
  if (items) return Array.from({ length: minItems! }, (_, place) => whole((value as readonly Toml[] | undefined)?.[place], items));
  return typeof value === "bigint" ? Number(value) : value ?? usual;
}

function armNumbers({ motor_equation, link, tip, gravity, joint, drive, follower_pots }: Whole): number[] {
  return [
    Number(motor_equation === "paper"),
    ...link.flatMap(({ mass, length, centre, inertia: { xx, yy, zz } }) => [mass, length, centre, xx, yy, zz]),
    tip.mass, gravity,
    ...joint.flatMap(({ motor, friction, gear, stops, driver }, number) => {
      const { play, lag } = follower_pots.joint[number]!;
      return [
        motor.inertia, motor.resistance + drive.resistance, motor.torque_constant, motor.viscous, motor.gear_ratio,
        friction.coulomb, friction.breakaway, friction.stribeck_velocity, friction.load, friction.creep_velocity,
        gear.half_gap, gear.stiffness, gear.damping, gear.drag, stops.min, stops.max, play, lag,
        driver.lost_up, driver.lost_down,
      ];
    }),
    drive.supply, drive.supply_resistance,
  ];
}

function potNumbers({ supply, joint }: Pots): number[] {
  return [...joint.flatMap(({ track, centre, direction, linearity, play, lag }) => [track, centre, direction, 0, linearity, play, lag]), supply];
}
