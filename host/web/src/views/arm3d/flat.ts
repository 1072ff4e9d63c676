// The arm from its side as a few lines: at once, while the picture in three dimensions is on its way, and where the browser has none.

import { svg } from "../../parts/dom";
import type { ArmDescription } from "../../session/services";
import { extentOf, motorPlaces, shares } from "./reach";

const SIZE = 240; // of the drawing's units, for the arm's reach
const ROOM = 0.12;

export class FlatArm {
  readonly element: SVGSVGElement;
  private readonly leader = svg("polyline", { class: "flat-leader" });
  private readonly follower = svg("polyline", { class: "flat-follower" });
  private readonly motors: readonly SVGCircleElement[];
  private readonly links: readonly number[];

  constructor(arm: ArmDescription) {
    this.links = shares(arm);
    const { points, floor: lowest } = extentOf(arm);
    const floor = -lowest * SIZE;
    const top = (Math.max(...points.map(([, , z]) => z)) + ROOM) * SIZE;
    const side = (1 - this.links[0]! + ROOM) * SIZE;
    this.motors = [0, 1, 2].map(() => svg("circle", { r: 11, class: "flat-motor" }));
    this.element = svg("svg", {
      viewBox: `${-side} ${-top} ${2 * side} ${top + floor + ROOM * SIZE}`, class: "flat", "aria-hidden": "true",
    },
    svg("line", { x1: -side, x2: side, y1: floor, y2: floor, class: "flat-floor" }),
    svg("line", { x1: 0, x2: 0, y1: 0, y2: floor, class: "flat-post" }),
    this.leader, this.follower, ...this.motors);
  }

  draw(leader: readonly number[], follower: readonly number[]): void {
    const line = (angles: readonly number[]): string => this.corners(angles).map(([x, y]) => `${x.toFixed(1)},${y.toFixed(1)}`).join(" ");
    this.leader.setAttribute("points", line(leader));
    this.follower.setAttribute("points", line(follower));
    const corners = this.corners(follower);
    this.motors.forEach((motor, joint) => {
      const [x, y] = corners[joint + 1]!;
      motor.setAttribute("cx", x.toFixed(1));
      motor.setAttribute("cy", y.toFixed(1));
    });
  }

  private corners(angles: readonly number[]): readonly (readonly [number, number])[] {
    return motorPlaces(this.links, angles).map(([x, , z]) => [x * SIZE, -z * SIZE]);
  }
}
