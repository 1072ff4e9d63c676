// The simulated bench under a person's hands: lead, break and mend, supply, load, slow motion, power.

import { upperFirst } from "../../link/refusal";
import { button, el, select, setText } from "../../parts/dom";
import { REASON } from "../in_the_way";
import type { View } from "../view";
import { SIZES, type Bench, type BenchControls, type BenchWish, type Services, type Range, type Size } from "../../session/services";
import type { Session } from "../../session/session";
import type { LeaderControl } from "./leader_control";
import { DrawnMotion } from "./drawn_motion";
import { Lead } from "./lead";

const TITLES: Readonly<Record<Size, readonly [title: string, unit: string]>> = {
  supply: ["Supply", "V"], load: ["Load at the tip", "kg"], noise: ["Sensor noise", "×"], play: ["Gear play", "×"],
  speed: ["Speed of time", "×"],
};

export class BenchView implements View {
  readonly name = "Bench";
  private readonly cards = el("div", { class: "editor" });
  readonly element = el("fieldset", { attrs: { "aria-describedby": REASON } }, this.cards);
  private lead: Lead | null = null;
  private drawn: DrawnMotion | null = null;
  private readonly recorded = el("select", { attrs: { "aria-label": "Recorded motion" } });
  private readonly broken = el("ul", { class: "differences" });

  /** Recorded motions are files of a host, where there is one. */
  constructor(
    private readonly session: Session, private readonly bench: Bench, private readonly leaderControl: LeaderControl,
    private readonly services: Pick<Services, "state"> | null, private readonly firmware: { readonly element: HTMLElement } | null = null,
  ) {
    session.changed.on(() => this.show());
  }

  /** A person who only watches leaves the bench alone while another page drives. */
  private show(): void {
    const { whyNotBench } = this.session;
    this.element.disabled = whyNotBench !== "";
    this.element.title = whyNotBench;
  }

  enter(): void {
    void this.session.attempt(async () => {
      const controls = await this.bench.controls();
      if (!this.lead) this.build(controls);
      if (controls.broken) this.broken.replaceChildren(...controls.broken.map((name) => el("li", {}, name)));
      if (!this.services) return;
      const motions = (await this.services.state()).files.filter(({ kind }) => kind === "motion");
      this.recorded.replaceChildren(el("option", { value: "" }, motions.length ? "a recorded motion" : "no motion in this folder"),
        ...motions.map(({ name }) => el("option", { value: name }, name)));
    });
  }

  private build(controls: BenchControls): void {
    this.lead = new Lead(this.leaderControl, this.session.samples, controls.leader);
    this.drawn = new DrawnMotion(this.leaderControl, controls.leader);
    this.cards.replaceChildren(el("div", { class: "side" }, this.lead.element, this.drawn.element),
      el("div", { class: "side" }, this.motions(), this.faults(controls), this.sizes(controls), ...(this.firmware ? [this.firmware.element] : [])));
  }

  private change(wish: BenchWish): Promise<boolean> {
    return this.session.attempt(() => this.bench.change(wish));
  }

  private motions(): HTMLElement {
    const lead = (motion: string): void => {
      void this.change({ motion });
      this.leaderControl.letGo();
    };
    this.recorded.addEventListener("change", () => {
      if (this.recorded.value) lead(this.recorded.value);
    });
    return el("section", { class: "card" }, el("h2", {}, "A person leads"),
      el("div", { class: "row" },
        button("Reach here and there", () => lead("reaches"), { title: "Smooth reaches, as a person makes them; while the motors are off" }),
        button("Hold still", () => lead("hold")), ...(this.services ? [this.recorded] : [])));
  }

  private faults({ faults }: BenchControls): HTMLElement {
    const words = el("p", { class: "quiet" });
    const place = select<string>("Where", [], () => undefined);
    const fault = select("Fault", faults.map(({ name }) => [name, name.replace(/-/g, " ")] as const), () => show());
    const show = (): void => {
      const chosen = faults.find(({ name }) => name === fault.value);
      setText(words, chosen ? `${upperFirst(chosen.description)}.` : "");
      place.replaceChildren(...(chosen?.places ?? []).map((one) => el("option", { value: one }, one)));
      place.hidden = !chosen?.places.length;
    };
    show();
    const breakIt = async (): Promise<void> => {
      const name = place.hidden ? fault.value : `${fault.value}:${place.value}`;
      if (await this.change({ fault: name })) this.broken.append(el("li", {}, name));
    };
    const mend = async (): Promise<void> => {
      if (await this.change({ fault: null })) this.broken.replaceChildren();
    };
    return el("section", { class: "card" }, el("h2", {}, "Break something"),
      el("div", { class: "row" }, fault, place, button("Break", () => void breakIt()), button("Mend all", () => void mend())),
      words, this.broken);
  }

  private sizes(controls: BenchControls): HTMLElement {
    const rows = SIZES.flatMap((size) => {
      const range = controls[size];
      return range ? [this.size(size, range)] : [];
    });
    return el("section", { class: "card" }, el("h2", {}, "Power, load, wear and time"), ...rows,
      el("div", { class: "row" },
        button("Cut the power", () => void this.change({ power: false })),
        button("Power on", () => void this.change({ power: true })),
        button("Press emergency stop", () => void this.change({ estop: true })),
        button("Release it", () => void this.change({ estop: false })),
        button("Press the clutch's pedal", () => void this.change({ clutch: true })),
        button("Release the pedal", () => void this.change({ clutch: false }))));
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
    return el("div", { class: "lead-row" }, el("span"), el("span", {}, title), slider, words);
  }

  frame(): void {
    this.lead?.draw();
    this.drawn?.frame();
  }
}
