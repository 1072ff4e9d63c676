// Leads the bench's leader arm by hand: sliders, and two pads on which two joints are dragged at once.

import { el, onDrag, setText } from "../../parts/dom";
import { JOINT_NAMES, type Samples } from "../../session/samples";
import type { LeaderControl } from "./leader_control";
import { angleAt, pointed, shareOf, type Limits } from "./limits";

type Pair = readonly [across: number, up: number];

const PADS: readonly Pair[] = [[0, 1], [3, 2]];

export class Lead {
  readonly element = el("section", { class: "card" });
  private readonly rows: { joint: number; slider: HTMLInputElement; words: HTMLElement }[] = [];
  private readonly pads: { joints: Pair; knob: HTMLElement; follower: HTMLElement }[] = [];

  constructor(private readonly leaderControl: LeaderControl, private readonly samples: Samples, private readonly limits: Limits) {
    const moves = (joint: number): boolean => limits.maximum[joint]! > limits.minimum[joint]!; // else there is no joint
    const rows = [...JOINT_NAMES.entries()].filter(([joint]) => moves(joint)).map(([joint, name]) => {
      const slider = el("input", { type: "range", attrs: {
        min: String(limits.minimum[joint]), max: String(limits.maximum[joint]), step: "0.01", "aria-label": `Leader, ${name}, rad`,
      }, on: { input: () => leaderControl.take(joint, Number(slider.value)) } });
      const words = el("span", { class: "number" }, "0.00");
      this.rows.push({ joint, slider, words });
      return el("div", { class: "lead-row" }, el("span", { class: `key key-${joint}` }), el("span", {}, `${joint} ${name}`), slider, words);
    });
    this.element.append(el("h2", {}, "Lead by hand"), ...rows,
      el("div", { class: "pads" }, ...PADS.filter((joints) => joints.some(moves)).map((joints) => this.pad(joints))));
  }

  private pad(joints: Pair): HTMLElement {
    const [across, up] = joints;
    const knob = el("div", { class: "knob" });
    const follower = el("div", { class: "knob follower" });
    const pad = el("div", { class: "pad", title: "Drag: the follower (ring) follows" }, follower, knob);
    onDrag(pad, (event) => {
      pointed(pad, event).forEach((share, axis) => {
        const joint = axis ? up : across;
        this.leaderControl.take(joint, angleAt(this.limits, joint, share));
      });
    });
    this.pads.push({ joints, knob, follower });
    return el("figure", {}, pad, el("figcaption", { class: "quiet" }, `${JOINT_NAMES[across]} →, ${JOINT_NAMES[up]} ↑`));
  }

  draw(): void {
    const shown = this.leaderControl.angles;
    const follower = this.samples.newest("follower");
    for (const { joint, slider, words } of this.rows) {
      const angle = shown[joint]!;
      if (document.activeElement !== slider || !this.leaderControl.leads) slider.value = String(angle);
      setText(words, angle.toFixed(2));
    }
    this.pads.forEach(({ joints: [across, up], knob, follower: ring }) => {
      this.put(knob, across, up, shown);
      this.put(ring, across, up, follower);
    });
  }

  private put(knob: HTMLElement, across: number, up: number, angles: readonly number[]): void {
    knob.style.left = `${100 * shareOf(this.limits, across, angles[across]!)}%`;
    knob.style.bottom = `${100 * shareOf(this.limits, up, angles[up]!)}%`;
  }
}
