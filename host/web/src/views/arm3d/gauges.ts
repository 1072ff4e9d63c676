// What a joint of the follower shows about itself: a ring that grows with its motor's voltage, with a needle for its angle, and
// beside it an arc from stop to stop; both are red where something is wrong.

import { CircleGeometry, Color, DoubleSide, Mesh, MeshBasicMaterial, TorusGeometry } from "three";
import type { ArmDescription } from "../../session/services";
import type { Colours } from "../../parts/theme";
import type { ArmModel } from "./model";
import { AXES, WRIST_BACK } from "./reach";
import { arc, together, turned } from "./shapes";

const AT_STOP_RAD = 0.03;
const RED = "#d12f3e";
const RING = 0.007;
const GAP = 0.014; // between a motor and its ring
const NEEDLE = 0.05;
const ARC = 0.01;
const GROWS = 0.3; // a ring, at the whole supply
const FAINTEST = 0.55; // of a joint's colour, without voltage
const FAINT_ARC = 0.4;
const FAULT_SIZE = 1.35;
const AT = [[0, 0, 0.018], [0, -0.06, 0], [0, -WRIST_BACK - 0.08, 0], [0.012, 0, 0]] as const; // in the joint's frame

class Gauge {
  readonly ring: Mesh<TorusGeometry, MeshBasicMaterial>;
  private readonly arc: Mesh<CircleGeometry, MeshBasicMaterial>;

  constructor(model: ArmModel, private readonly joint: number, radius: number, private readonly min: number, private readonly max: number) {
    const axis = AXES[joint]!;
    const size = radius + GAP + (joint === 0 ? 0.02 : 0);
    const needle = new CircleGeometry(1, 3).scale(NEEDLE / 2, RING * 1.4, 1).translate(size + NEEDLE / 2, 0, 0);
    const round = new TorusGeometry(size, RING, 8, 44);
    for (const part of [needle, round]) turned(part, axis);
    this.ring = new Mesh(together(round, needle) as TorusGeometry, new MeshBasicMaterial({ side: DoubleSide }));
    this.arc = new Mesh(arc(axis, min, max, size + NEEDLE, size + NEEDLE + ARC) as CircleGeometry, new MeshBasicMaterial({ side: DoubleSide, transparent: true, depthWrite: false }));
    const frame = model.frames[joint]!;
    this.ring.position.fromArray(AT[joint]!);
    this.arc.position.copy(frame.position).add(this.ring.position);
    frame.add(this.ring);
    frame.parent!.add(this.arc);
  }

  show(shades: Colours, angle: number, share: number, faulty: boolean): void {
    const strength = Math.min(1, Math.abs(share));
    if (faulty) this.ring.material.color.set(RED);
    else this.ring.material.color.set(shades.line).lerp(new Color(shades.joints[this.joint]), FAINTEST + (1 - FAINTEST) * strength);
    this.ring.scale.setScalar(faulty ? FAULT_SIZE : 1 + GROWS * strength);
    const atStop = angle < this.min + AT_STOP_RAD || angle > this.max - AT_STOP_RAD;
    this.arc.material.color.set(faulty || atStop ? RED : shades.quiet);
    this.arc.material.opacity = faulty || atStop ? 1 : FAINT_ARC;
  }
}

export class Gauges {
  private readonly gauges: readonly (Gauge | null)[]; // null at a fixed joint

  constructor(model: ArmModel, arm: ArmDescription, radii: readonly number[]) {
    this.gauges = arm.joints.map(({ min, max, fixed }, joint) => (fixed ? null : new Gauge(model, joint, radii[joint]!, min, max)));
  }

  /** `voltage` is a share of the supply, `faulty` the joint at which a fault sits. */
  show(shades: Colours, angles: readonly number[], voltage: readonly number[], faulty: number | null): void {
    this.gauges.forEach((gauge, joint) => gauge?.show(shades, angles[joint]!, voltage[joint]!, joint === faulty));
  }
}
