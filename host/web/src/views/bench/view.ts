// The simulated bench under a person's hands, beside the moving arm: lead, break and mend, supply, load, slow motion, power.

import { button, el, setText } from "../../parts/dom";
import { REASON } from "../in_the_way";
import type { View } from "../view";
import { SIZES, type Bench, type BenchControls, type BenchWish, type Services, type Range, type Size } from "../../session/services";
import type { Session } from "../../session/session";
import type { ArmPicture } from "../arm3d/picture";
import type { LeaderControl } from "./leader_control";
import { DrawnMotion } from "./drawn_motion";
import { Faults } from "./faults";
import { Following } from "./following";
import { Lead } from "./lead";
import { Played } from "./played";

const TITLES: Readonly<Record<Size, readonly [title: string, unit: string]>> = {
  supply: ["Supply", "V"], load: ["Load at the tip", "kg"], noise: ["Sensor noise", "×"], play: ["Gear play", "×"],
  speed: ["Speed of time", "×"],
};
/** A switch of the bench: what turns it on and off, in the words of both buttons. */
const SWITCHES: readonly (readonly [on: string, BenchWish, off: string, BenchWish])[] = [
  ["Cut the power", { power: false }, "Switch the power on", { power: true }],
  ["Press the emergency stop", { estop: true }, "Release the emergency stop", { estop: false }],
  ["Press the clutch's pedal", { clutch: true }, "Release the clutch's pedal", { clutch: false }],
];

export class BenchView implements View {
  readonly name = "Bench";
  private readonly controls = el("fieldset", { attrs: { "aria-describedby": REASON } });
  private readonly following: Following;
  private readonly armPlace: HTMLElement;
  readonly element: HTMLElement;
  private lead: Lead | null = null;
  private drawn: DrawnMotion | null = null;
  private faults: Faults | null = null;
  private played: Played | null = null; // where no host has recorded motions
  private readonly recorded = el("select", { attrs: { "aria-label": "Recorded motion" } });

  /** Recorded motions are files of a host, where there is one. */
  constructor(
    private readonly session: Session, private readonly bench: Bench, private readonly leaderControl: LeaderControl,
    private readonly arm: ArmPicture, private readonly services: Pick<Services, "state"> | null,
    private readonly firmware: { readonly element: HTMLElement } | null = null,
  ) {
    this.following = new Following(session, leaderControl);
    this.armPlace = el("div", { class: "side" }, this.following.element);
    this.element = el("div", { class: "bench" }, this.armPlace, this.controls);
    session.changed.on(() => this.show());
  }

  /** A person who only watches leaves the bench alone while another page drives. */
  private show(): void {
    const { whyNotBench } = this.session;
    this.controls.disabled = whyNotBench !== "";
    this.controls.title = whyNotBench;
  }

  enter(): void {
    this.arm.showIn(this.armPlace);
    this.following.enter();
    void this.session.attempt(async () => {
      const controls = await this.bench.controls();
      if (!this.lead) this.build(controls);
      this.faults?.show(controls);
      if (!this.services) return;
      const motions = (await this.services.state()).files.filter(({ kind }) => kind === "motion");
      this.recorded.replaceChildren(el("option", { value: "" }, motions.length ? "a recorded motion" : "no motion in this folder"),
        ...motions.map(({ name }) => el("option", { value: name }, name)));
    });
  }

  private build(controls: BenchControls): void {
    this.lead = new Lead(this.leaderControl, this.session.samples, controls.leader);
    this.drawn = new DrawnMotion(this.leaderControl, controls.leader);
    if (!this.services) this.played = new Played(this.session, this.leaderControl, controls.leader);
    this.faults = new Faults(this.session, this.bench, controls.faults);
    this.controls.replaceChildren(
      el("div", { class: "side" }, this.lead.element, this.motions(controls), this.drawn.element, ...(this.played ? [this.played.element] : [])),
      el("div", { class: "side" }, this.faults.element, this.sizes(controls), ...(this.firmware ? [this.firmware.element] : [])));
  }

  private change(wish: BenchWish): Promise<boolean> {
    return this.session.attempt(() => this.bench.change(wish));
  }

  private motions({ motions }: BenchControls): HTMLElement {
    const lead = async (motion: string): Promise<void> => {
      if (!(await this.change({ motion }))) return;
      this.leaderControl.letGo();
      this.played?.stop();
    };
    this.recorded.addEventListener("change", () => {
      if (this.recorded.value) void lead(this.recorded.value);
    });
    return el("section", { class: "card" }, el("h2", {}, "Let another hand lead"),
      el("div", { class: "row" },
        ...motions.map(({ name, title }) => button(title, () => void lead(name), { title: "From where the leader is, at once" })),
        button("Hold still", () => void lead("hold")), ...(this.services ? [this.recorded] : [])));
  }

  private sizes(controls: BenchControls): HTMLElement {
    const rows = SIZES.flatMap((size) => {
      const range = controls[size];
      return range ? [this.size(size, range)] : [];
    });
    return el("section", { class: "card" }, el("h2", {}, "Power, load, wear and time"), ...rows,
      el("div", { class: "switches" }, ...SWITCHES.flatMap(([on, press, off, release]) => [
        button(on, () => void this.change(press)), button(off, () => void this.change(release)),
      ])));
  }

  private size(key: Size, range: Range): HTMLElement {
    const [title, unit] = TITLES[key];
    const words = el("span", { class: "number" });
    const show = (): void => setText(words, `${Number(Number(slider.value).toFixed(3))} ${unit}`);
    const slider = el("input", { type: "range", attrs: {
      min: String(range.minimum), max: String(range.maximum), step: String(range.step ?? (range.maximum - range.minimum) / 100),
      "aria-label": `${title}, ${unit}`,
    }, on: { input: () => show(), change: () => void this.change({ [key]: Number(slider.value) }) } });
    slider.value = String(range.value);
    show();
    return el("div", { class: "lead-row plain" }, el("span", {}, title), slider, words);
  }

  frame(): void {
    this.arm.frame();
    this.following.frame();
    this.lead?.draw();
    this.drawn?.frame();
    this.played?.frame();
  }
}
