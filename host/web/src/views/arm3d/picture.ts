// The arm as it moves, for any view that shows it: one picture, which goes to where it is looked at. What draws it in three
// dimensions is loaded when somebody looks for the first time; until then, and without WebGL, a few lines show the pose.

import { JOINT_NAMES } from "../../session/samples";
import { button, el, setText } from "../../parts/dom";
import { sentenceOf } from "../../parts/sentence";
import { colours, isDark, themeChanged } from "../../parts/theme";
import type { LeaderControl } from "../bench/leader_control";
import type { ArmDescription, Services } from "../../session/services";
import { faultPlace, upperFirst } from "../../link/refusal";
import { TABLE } from "../../link/schema";
import type { Session } from "../../session/session";
import { FlatArm } from "./flat";
import type { ArmScene, Preset } from "./scene";

const PRESET_NAMES: readonly Preset[] = ["corner", "front", "side", "top"];
const GAUGES = "Rings grow with the voltage; arcs end at the stops, and are red when one is reached";
const MARK_ROOM = 0.28; // of the picture's width, for half of a mark where it is narrow
const DEFAULT_SUPPLY_V = TABLE.named("supply_mv").initial / 1000;

export class ArmPicture {
  readonly element: HTMLElement;
  private readonly canvas = el("canvas", { attrs: { role: "img", "aria-label": "The arm: follower solid, leader as a ghost" }, hidden: true, title: GAUGES });
  private readonly words = el("p", { class: "quiet" }, "Loading the arm.");
  private readonly mark = el("p", { class: "mark", hidden: true });
  private readonly sides: HTMLElement;
  private readonly stage: HTMLElement;
  private flat: FlatArm | null = null;
  private scene: ArmScene | null = null;
  private leaderControl: LeaderControl | null = null;
  private loading = false;

  /** `services` bring the arm. */
  constructor(private readonly session: Session, private readonly services: Pick<Services, "arm">) {
    const sides = PRESET_NAMES.map((preset) => button(upperFirst(preset), () => this.scene?.look(preset), { title: "Look from there" }));
    this.sides = el("div", { class: "sides", hidden: true }, ...sides);
    this.stage = el("div", { class: "stage" }, this.canvas, this.mark, this.sides);
    this.element = el("section", { class: "card arm", attrs: { "aria-label": "The arm" } }, this.stage, this.words);
    themeChanged.on(() => this.scene?.paint(colours(), isDark()));
    new ResizeObserver(() => this.resize()).observe(this.stage);
  }

  /** From now on the leader's joints can be dragged. */
  leadBy(leaderControl: LeaderControl): void {
    this.leaderControl = leaderControl;
    this.scene?.leadBy(leaderControl);
  }

  /** Moves the picture to the beginning of this place, from wherever it was; for a view that comes to the front. */
  showIn(place: HTMLElement): void {
    if (this.element.parentElement !== place) place.prepend(this.element);
    if (this.scene || this.loading) return;
    this.loading = true;
    this.load().catch((error: unknown) => setText(this.words, sentenceOf(error))).finally(() => { this.loading = false; });
  }

  private async load(): Promise<void> {
    setText(this.words, "Loading the arm.");
    const drawing = import("./scene");
    const arm = await this.services.arm();
    if (!this.flat) {
      this.flat = new FlatArm(arm);
      this.stage.prepend(this.flat.element);
    }
    const { ArmScene } = await drawing;
    const scene = this.scene = await ArmScene.on(this.canvas, arm);
    scene.paint(colours(), isDark());
    scene.leadBy(this.leaderControl);
    this.canvas.addEventListener("webglcontextlost", () => {
      this.hide(true);
      setText(this.words, "The browser has taken the graphics of this view away; it gives them back, or reload the page. All other views go on.");
    });
    this.canvas.addEventListener("webglcontextrestored", () => void this.show(scene, arm));
    await this.show(scene, arm);
  }

  /** Shows the canvas once the graphics processor has drawn what it needs long for. */
  private async show(scene: ArmScene, { name }: ArmDescription): Promise<void> {
    await scene.warm();
    if (scene.lost) return;
    this.hide(false);
    this.resize();
    setText(this.words, `${upperFirst(name)}: solid is the follower, a ghost the leader.${this.leaderControl ? " Drag a link to lead." : ""}`);
  }

  /** Hides the canvas, and shows the lines in its place; or the other way round. */
  private hide(hidden: boolean): void {
    this.canvas.hidden = this.sides.hidden = hidden;
    this.flat?.element.toggleAttribute("hidden", !hidden);
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.stage;
    if (clientWidth && clientHeight && !this.canvas.hidden) this.scene?.resize(clientWidth, clientHeight);
  }

  /** Draws the newest sample; to be called for each picture of the screen by the view that shows it. */
  frame(): void {
    const { samples, status, faulty, parameters } = this.session;
    if (!samples.end) return;
    const [leader, follower] = [samples.newest("leader"), samples.newest("follower")];
    const fault = faulty && status ? faultPlace(status) : null;
    if (this.scene && !this.canvas.hidden) {
      const supply = parameters ? parameters[TABLE.named("supply_mv").index]! / 1000 : DEFAULT_SUPPLY_V;
      const voltage = samples.newest("voltage").map((volts) => volts / supply);
      this.drawIn(this.scene, { leader, follower, voltage, faulty: fault?.joint ?? null });
      this.canvas.dataset["tick"] = String(samples.lastTick);
    } else {
      this.flat?.draw(leader, follower);
    }
    this.mark.hidden = !fault;
    if (!fault) return;
    setText(this.mark, `${upperFirst(fault.words)}, ${JOINT_NAMES[fault.joint]}`);
    const [x, y] = this.scene && !this.canvas.hidden ? this.scene.placeOf(fault.joint) : [0.5, 0.1];
    this.mark.style.left = `${(100 * Math.max(MARK_ROOM, Math.min(1 - MARK_ROOM, x))).toFixed(1)}%`;
    this.mark.style.top = `${(100 * y).toFixed(1)}%`;
  }

  private drawIn(scene: ArmScene, pose: Parameters<ArmScene["draw"]>[0]): void {
    const begun = performance.now();
    if (scene.draw(pose)) setTimeout(() => scene.took(performance.now() - begun)); // behind the picture's painting
  }
}
