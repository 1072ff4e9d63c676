// The arm in three dimensions. What draws it is loaded when somebody looks for the first time.

import { button, el, setText } from "../../parts/dom";
import { sentenceOf } from "../../parts/sentence";
import { colours, themeChanged } from "../../parts/theme";
import type { LeaderControl } from "../bench/leader_control";
import type { View } from "../view";
import type { Services } from "../../session/services";
import { upperFirst } from "../../link/refusal";
import { TABLE } from "../../link/schema";
import type { Session } from "../../session/session";
import type { ArmScene, Preset } from "./scene";

const PRESET_NAMES: readonly Preset[] = ["corner", "front", "side", "top"];
const DEFAULT_SUPPLY_V = TABLE.named("supply_mv").initial / 1000;

export class ArmView implements View {
  readonly name = "Arm";
  readonly element: HTMLElement;
  private readonly canvas = el("canvas", { attrs: { role: "img", "aria-label": "The arm: follower solid, leader as a ghost" }, hidden: true });
  private readonly words = el("p", { class: "quiet" }, "Loading the arm.");
  private scene: ArmScene | null = null;
  private leaderControl: LeaderControl | null = null;
  private loading = false;

  constructor(private readonly session: Session, private readonly services: Pick<Services, "arm">) {
    this.element = el("section", { class: "card arm" },
      el("div", { class: "tools" }, ...PRESET_NAMES.map((preset) =>
        button(upperFirst(preset), () => this.scene?.look(preset))), this.words),
      el("div", { class: "stage" }, this.canvas));
    themeChanged.on(() => this.scene?.paint(colours()));
    new ResizeObserver(() => this.resize()).observe(this.element);
  }

  /** From now on the leader's joints can be dragged. */
  leadBy(leaderControl: LeaderControl): void {
    this.leaderControl = leaderControl;
    this.scene?.leadBy(leaderControl);
  }

  enter(): void {
    if (this.scene || this.loading) return;
    this.loading = true;
    this.load().catch((error: unknown) => setText(this.words, sentenceOf(error))).finally(() => { this.loading = false; });
  }

  private async load(): Promise<void> {
    setText(this.words, "Loading the arm.");
    const [{ ArmScene }, arm] = await Promise.all([import("./scene"), this.services.arm()]);
    const scene = this.scene = await ArmScene.on(this.canvas, arm);
    scene.paint(colours());
    scene.leadBy(this.leaderControl);
    this.canvas.addEventListener("webglcontextlost", () => {
      this.canvas.hidden = true;
      setText(this.words, "The browser has taken the graphics of this view away; it gives them back, or reload the page. All other views go on.");
    });
    this.canvas.addEventListener("webglcontextrestored", () => void this.show(scene, arm.name));
    await this.show(scene, arm.name);
  }

  /** Shows the canvas once the graphics processor has drawn what it needs long for. */
  private async show(scene: ArmScene, name: string): Promise<void> {
    this.resize();
    await scene.warm();
    if (scene.lost) return;
    this.canvas.hidden = false;
    this.resize();
    setText(this.words, `${name}: solid is the follower, the ghost the leader; rings grow with the voltage, arcs end at the stops, red when one is reached.${this.leaderControl ? " Drag a link to lead." : ""}`);
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.canvas.parentElement!;
    if (clientWidth && clientHeight) this.scene?.resize(clientWidth, clientHeight);
  }

  frame(): void {
    const { samples, parameters } = this.session;
    if (!this.scene || this.canvas.hidden || !samples.end) return;
    const supply = parameters ? parameters[TABLE.named("supply_mv").index]! / 1000 : DEFAULT_SUPPLY_V;
    this.scene.draw({
      leader: samples.newest("leader"), follower: samples.newest("follower"),
      voltage: samples.newest("voltage").map((volts) => volts / supply),
    });
    this.canvas.dataset["tick"] = String(samples.lastTick);
  }
}
