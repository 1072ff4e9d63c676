// The arm as bodies that turn about each other, in units of its reach; z is up. What is drawn of a link is made once, and
// shown by follower, leader and shadow alike.

import { Group, Mesh, type BufferGeometry, type Material } from "three";
import type { ArmDescription } from "../../session/services";
import { AXES, FOOT, SHOULDER_ASIDE, shares, WRIST_BACK } from "./reach";
import { bar, box, together, tube } from "./shapes";

const SHELL = "#dfe6eb"; // printed parts
const STEEL = "#8b9aa6"; // brackets and the stand
const MOTOR = "#43525e";
const CAP = "#d9a03c"; // of a potentiometer's shaft
const THICK = 0.062; // of a link
const MOTOR_OUT = 0.05; // of the wrist's motor beyond its link
const RADII = [0.095, 0.08, 0.064, 0.05]; // of the motors
const LEAST = 0.016;
const POST = 0.042;

/** What is drawn of an arm's links and of its stand, whose foot is at `floor`. */
export type Parts = { readonly links: readonly BufferGeometry[]; readonly stand: BufferGeometry; readonly radii: readonly number[] };

/** Radius of each joint's motor: none is longer than a link beside it leaves room for. */
export function motorRadii(links: readonly number[]): readonly number[] {
  return RADII.map((usual, joint) => {
    const room = joint === 0 ? 1 : Math.min(links[joint]!, links[joint - 1]!) / 2;
    return Math.max(LEAST, Math.min(usual, room));
  });
}

/** Makes them one after the other, and lets the page do all else between them. */
export async function makeParts(arm: ArmDescription, floor: number, pause: () => Promise<void>): Promise<Parts> {
  const links = shares(arm);
  const radii = motorRadii(links);
  const motor = (joint: number): string => (arm.joints[joint]!.fixed ? STEEL : MOTOR);
  const cap = (joint: number, axis: "side" | "up", from: number, to: number, radius: number): BufferGeometry[] =>
    arm.joints[joint]!.fixed ? [] : [tube(CAP, axis, Math.min(from, to), Math.max(from, to), radius)];
  const [base, upper, middle, hand] = links as [number, number, number, number];
  const [, shoulder, wrist, roll] = radii as [number, number, number, number];
  const inner = SHOULDER_ASIDE - THICK / 2;
  const turret = together(
    tube(SHELL, "up", 0.004, 0.035, 0.1, 0.095), tube(SHELL, "up", 0.035, Math.max(0.04, base), 0.085, 0.068),
    ...[
      tube(motor(1), "side", -inner, 0.08, shoulder), tube(STEEL, "side", 0.08, 0.093, 0.8 * shoulder), ...cap(1, "side", 0.093, 0.118, 0.3 * shoulder),
    ].map((part) => part.translate(0, 0, base)),
  );
  await pause();
  const outer = -THICK / 2 - MOTOR_OUT;
  const arm1 = together(
    bar(SHELL, upper, shoulder, wrist, THICK), tube(STEEL, "side", -THICK / 2 - 0.012, 0, 0.55 * shoulder),
    tube(motor(2), "side", outer, 0.01, 0.94 * wrist).translate(upper, 0, 0),
    ...cap(2, "side", outer - 0.02, outer, 0.34 * wrist).map((part) => part.translate(upper, 0, 0)),
  );
  await pause();
  const arm2 = together(
    bar(SHELL, middle, wrist, roll, 0.8 * THICK),
    tube(motor(3), "along", 0.45 * middle, middle - 0.004, 0.86 * roll),
  );
  await pause();
  const end = gripper(hand, roll);
  await pause();
  return { links: [turret, arm1, arm2, end], stand: stand(floor, motor(0)), radii };
}

/** The hand: a flange, a palm, and two fingers that end at the tip. */
function gripper(length: number, radius: number): BufferGeometry {
  const palm = 0.55 * length;
  const wide = Math.min(0.09, 0.9 * length);
  const finger = (side: number): BufferGeometry => {
    const made = box(MOTOR, [length - palm, 0.2 * wide, 0.42 * wide], [(length + palm) / 2, 0, 0]);
    made.rotateZ(-side * 0.1); // closing towards the tip
    return made.translate(0, side * (0.36 * wide + 0.1 * length), 0);
  };
  return together(
    tube(STEEL, "along", 0, 0.12 * length, radius), tube(SHELL, "along", 0.12 * length, palm - 0.1 * length, 0.7 * radius, 0.6 * radius),
    box(SHELL, [0.2 * length, 1.3 * wide, 0.6 * wide], [palm - 0.06 * length, 0, 0]), finger(1), finger(-1),
  );
}

/** A plate under the base, with the first motor below it, and where the arm reaches lower a post to the floor. */
function stand(floor: number, motor: string): BufferGeometry {
  const foot = floor + 0.022;
  const parts = [tube(STEEL, "up", -0.022, 0, 0.112), tube(STEEL, "up", floor, foot, FOOT, 0.94 * FOOT)];
  if (foot < -0.05) {
    const under = Math.max(foot, -0.16);
    parts.push(tube(motor, "up", under, -0.022, 0.08, 0.088));
    if (foot < under) parts.push(tube(STEEL, "up", foot, under, POST));
  }
  return together(...parts);
}

/** An arm that takes a pose. `frames` are its joints' own frames, each turning with the link that the joint moves. */
export class ArmModel {
  readonly root = new Group();
  readonly frames: readonly Group[];
  /** What each link is drawn with, one mesh for each of its materials. */
  readonly links: readonly (readonly Mesh[])[];

  constructor(private readonly arm: ArmDescription, parts: Parts, materials: (joint: number) => readonly Material[]) {
    const [base, upper, middle] = shares(arm) as [number, number, number];
    const at = [[0, 0, 0], [0, -SHOULDER_ASIDE, base], [upper, WRIST_BACK, 0], [middle, 0, 0]] as const;
    this.frames = at.map(([x, y, z]) => {
      const frame = new Group();
      frame.position.set(x, y, z);
      return frame;
    });
    this.frames.forEach((frame, joint) => (this.frames[joint - 1] ?? this.root).add(frame));
    this.links = parts.links.map((geometry, joint) => materials(joint).map((material) => {
      const mesh = new Mesh(geometry, material);
      this.frames[joint]!.add(mesh);
      return mesh;
    }));
  }

  /** Takes a pose, rad. */
  pose(angles: readonly number[]): void {
    this.frames.forEach(({ rotation }, joint) => {
      const angle = this.arm.joints[joint]!.fixed ? 0 : angles[joint]!;
      if (AXES[joint] === "up") rotation.z = angle;
      else if (AXES[joint] === "side") rotation.y = -angle; // a positive pitch is up
      else rotation.x = angle;
    });
  }
}
