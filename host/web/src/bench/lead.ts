// Leads the bench's leader arm by hand: sliders, and two pads on which two joints are dragged at once.

import { el, setText } from "../parts/dom";
import type { Bench, BenchControls } from "../host";
import { COUNT, JOINTS, traceOf, type Samples } from "../samples/samples";

const PADS: readonly (readonly [across: number, up: number])[] = [[0, 1], [3, 2]];
const NAMES = ["base yaw", "shoulder pitch", "wrist pitch", "wrist roll"];

export class Lead {
  readonly element = el("section", { class: "card" });
  private readonly wanted: number[] = new Array<number>(JOINTS).fill(0);
  private readonly sliders: HTMLInputElement[] = [];
  private readonly words: HTMLElement[] = [];
  private readonly pads: { pad: HTMLElement; knob: HTMLElement; follower: HTMLElement }[] = [];
  private sending = false;
  private waiting = false;
  private held = false; // a hand leads; until then the sliders follow the leader

  constructor(
    private readonly bench: Bench, private readonly samples: Samples, private readonly limits: BenchControls["leader"],
    private readonly failed: (error: unknown) => void,
  ) {
    const rows = NAMES.map((name, joint) => {
      const slider = el("input", { type: "range", attrs: {
        min: String(limits.minimum[joint]), max: String(limits.maximum[joint]), step: "0.01", "aria-label": `Leader, ${name}, rad`,
      }, on: { input: () => this.take(joint, Number(slider.value)) } });
      const words = el("span", { class: "number" }, "0.00");
      this.sliders.push(slider);
      this.words.push(words);
      return el("div", { class: "lead-row" }, el("span", { class: `key key-${joint}` }), el("span", {}, `${joint} ${name}`), slider, words);
    });
    this.element.append(el("h2", {}, "Lead by hand"), ...rows,
      el("div", { class: "pads" }, ...PADS.map((joints) => this.pad(joints))));
  }

  private pad([across, up]: readonly [number, number]): HTMLElement {
    const knob = el("div", { class: "knob" });
    const follower = el("div", { class: "knob follower" });
    const pad = el("div", { class: "pad", title: "Drag: the follower (ring) follows" }, follower, knob);
    const drag = (event: PointerEvent): void => {
      const box = pad.getBoundingClientRect();
      this.take(across, this.angleAt(across, (event.clientX - box.left) / box.width));
      this.take(up, this.angleAt(up, 1 - (event.clientY - box.top) / box.height));
    };
    pad.addEventListener("pointerdown", (event) => {
      pad.setPointerCapture(event.pointerId);
      drag(event);
    });
    pad.addEventListener("pointermove", (event) => {
      if (pad.hasPointerCapture(event.pointerId)) drag(event);
    });
    this.pads.push({ pad, knob, follower });
    return el("figure", {}, pad, el("figcaption", { class: "quiet" }, `${NAMES[across]} →, ${NAMES[up]} ↑`));
  }

  private angleAt(joint: number, share: number): number {
    const low = this.limits.minimum[joint]!;
    return low + Math.max(0, Math.min(1, share)) * (this.limits.maximum[joint]! - low);
  }

  private shareOf(joint: number, angle: number): number {
    const low = this.limits.minimum[joint]!;
    return Math.max(0, Math.min(1, (angle - low) / (this.limits.maximum[joint]! - low)));
  }

  private take(joint: number, angle: number): void {
    if (!this.held) this.wanted.splice(0, JOINTS, ...this.angles("leader"));
    this.held = true;
    this.wanted[joint] = angle;
    this.waiting = true;
    void this.send();
  }

  /** While one wish is on its way only the newest waits. */
  private async send(): Promise<void> {
    if (this.sending) return;
    this.sending = true;
    while (this.waiting) {
      this.waiting = false;
      try {
        await this.bench.change({ leader: this.wanted });
      } catch (error) {
        this.failed(error);
      }
    }
    this.sending = false;
  }

  /** Another motion leads now: the sliders follow it. */
  letGo(): void {
    this.held = false;
  }

  private angles(quantity: "leader" | "follower"): number[] {
    const { samples } = this;
    if (!samples.end) return new Array<number>(JOINTS).fill(0);
    return Array.from({ length: JOINTS }, (_, joint) => samples.count(samples.end - 1, traceOf(quantity, joint)) * COUNT[quantity]);
  }

  draw(): void {
    const shown = this.held ? this.wanted : this.angles("leader");
    const follower = this.angles("follower");
    shown.forEach((angle, joint) => {
      const slider = this.sliders[joint]!;
      if (document.activeElement !== slider || !this.held) slider.value = String(angle);
      setText(this.words[joint]!, angle.toFixed(2));
    });
    this.pads.forEach(({ knob, follower: ring }, place) => {
      const [across, up] = PADS[place]!;
      this.put(knob, across, up, shown);
      this.put(ring, across, up, follower);
    });
  }

  private put(knob: HTMLElement, across: number, up: number, angles: readonly number[]): void {
    knob.style.left = `${100 * this.shareOf(across, angles[across]!)}%`;
    knob.style.bottom = `${100 * this.shareOf(up, angles[up]!)}%`;
  }
}
