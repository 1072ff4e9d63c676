// Where the parts of an arm can be, in units of its reach: the floor below it, and the place of a camera that sees it all.
// No graphics here.

import type { ArmDescription } from "../../session/services";

export type Point = readonly [x: number, y: number, z: number];

/** The joints of every arm: base yaw, shoulder pitch, wrist pitch, wrist roll; and what turns about which line. */
export const AXES = ["up", "side", "side", "along"] as const;
export const SHOULDER_ASIDE = 0.185; // the upper arm hangs beside the base, so that it can pass by it
export const WRIST_BACK = 0.07; // the wrist is that much nearer to the middle
export const FOOT = 0.2; // radius of the stand's
const ROOM = 0.08; // around the line from joint to joint: motors, rings, arcs
const STEPS = [13, 17, 7] as const; // of the first three joints between their stops
const FLOOR_ROOM = 0.06; // between the floor and the lowest place that the arm reaches
const PLATE = 0.045; // of an arm that reaches below its base at no pose: it stands on the floor

/** Link lengths as shares of the reach, which is their sum. */
export function shares({ lengths }: Pick<ArmDescription, "lengths">): readonly number[] {
  const reach = lengths.reduce((sum, length) => sum + length, 0);
  return lengths.map((length) => (reach > 0 ? length / reach : 1 / lengths.length));
}

/** Shoulder, wrist, roll joint and tip at these angles (rad). */
export function places(links: readonly number[], [yaw = 0, shoulder = 0, wrist = 0]: readonly number[]): readonly Point[] {
  const placed = (along: number, aside: number, up: number): Point => [
    along * Math.cos(yaw) - aside * Math.sin(yaw), along * Math.sin(yaw) + aside * Math.cos(yaw), up,
  ];
  const [base, upper, middle, hand] = links as [number, number, number, number];
  const back = WRIST_BACK - SHOULDER_ASIDE;
  const along = upper * Math.cos(shoulder);
  const up = base + upper * Math.sin(shoulder);
  const pitch = shoulder + wrist;
  const on = (length: number): Point => placed(along + length * Math.cos(pitch), back, up + length * Math.sin(pitch));
  return [placed(0, -SHOULDER_ASIDE, base), on(0), on(middle), on(middle + hand)];
}

/** The base's foot, and the same places as seen from the side: as if the base were not turned. */
export function motorPlaces(links: readonly number[], angles: readonly number[]): readonly Point[] {
  return [[0, 0, 0], ...places(links, [0, ...angles.slice(1)])];
}

/** All places that an arm reaches within its stops, as a cloud of points. */
function cloud(arm: Pick<ArmDescription, "lengths" | "joints">): readonly Point[] {
  const links = shares(arm);
  const angles = STEPS.map((steps, joint) => {
    const { min, max, fixed } = arm.joints[joint]!;
    return fixed ? [0] : Array.from({ length: steps }, (_, step) => min + ((max - min) * step) / (steps - 1));
  });
  return angles[0]!.flatMap((yaw) => angles[1]!.flatMap((shoulder) => angles[2]!.flatMap((wrist) => places(links, [yaw, shoulder, wrist]))));
}

/** The height of a floor that the arm never reaches; its base stands at 0. */
function floorBelow(points: readonly Point[]): number {
  const lowest = Math.min(...points.map(([, , z]) => z));
  return lowest - ROOM / 2 > -PLATE ? -PLATE : lowest - ROOM / 2 - FLOOR_ROOM;
}

/** The corners of the stand's foot, which the arm's base is above. */
function foot(floor: number): readonly Point[] {
  const most = FOOT - ROOM; // the points have room about them
  return [[-most, -most, floor], [-most, most, floor], [most, -most, floor], [most, most, floor]];
}

/** What a camera is to show of an arm: where it can be, the foot of its stand on the floor at that height, and the middle. */
export type Extent = { readonly points: readonly Point[]; readonly floor: number; readonly middle: Point };

export function extentOf(arm: Pick<ArmDescription, "lengths" | "joints">): Extent {
  const reached = cloud(arm);
  const floor = floorBelow(reached);
  const points = [...reached, ...foot(floor)];
  return { points, floor, middle: [0, 0, (Math.max(...points.map(([, , z]) => z)) + floor) / 2] };
}

/**
 * The place of a camera that looks at the middle from this side and has all points in its picture, as near as can be; `field`
 * is the angle from bottom to top.
 */
export function cameraPlace({ points, middle }: Extent, from: Point, field: number, aspect: number): Point {
  const towards = unit(from);
  const right = unit(cross([0, 0, 1], towards));
  const up = cross(towards, right);
  const high = Math.tan(field / 2);
  const wide = high * aspect;
  const distance = Math.max(...points.map((point) => {
    const away = minus(point, middle);
    const needed = Math.max((Math.abs(dot(away, right)) + ROOM) / wide, (Math.abs(dot(away, up)) + ROOM) / high);
    return needed + dot(away, towards);
  }));
  return [middle[0] + distance * towards[0], middle[1] + distance * towards[1], middle[2] + distance * towards[2]];
}

function minus(one: Point, other: Point): Point {
  return [one[0] - other[0], one[1] - other[1], one[2] - other[2]];
}

function dot(one: Point, other: Point): number {
  return one[0] * other[0] + one[1] * other[1] + one[2] * other[2];
}

function cross(one: Point, other: Point): Point {
  return [one[1] * other[2] - one[2] * other[1], one[2] * other[0] - one[0] * other[2], one[0] * other[1] - one[1] * other[0]];
}

function unit(point: Point): Point {
  const length = Math.sqrt(dot(point, point));
  return [point[0] / length, point[1] / length, point[2] / length];
}
