// From potentiometers mounted anyhow to angles, by hand, one step after the other: a sweep of each joint, four poses,
// pulses of the motors; mistakes of the wiring by name. Nothing is stored before a person has seen what was found.

import { parameterFile } from "../../files/parameter_file";
import { fixed } from "../../files/words";
import { LinkError } from "../../link/declared";
import { upperFirst } from "../../link/refusal";
import { TABLE } from "../../link/schema";
import { download, el, select } from "../../parts/dom";
import { FULL_SCALE, COUNT14_PER_COUNT, potParameter, potsOf } from "../../session/pots";
import { JOINT_NAMES, JOINTS } from "../../session/samples";
import type { Bench, Calibrations, HandsWish, KeptCalibration } from "../../session/services";
import type { Session } from "../../session/session";
import { PotBars } from "../pots/bars";
import type { Countdown } from "../verbs/countdown";
import type { View } from "../view";
import { earlierList, withCalibration } from "./earlier";
import { Hands } from "./hands";
import { StepPanel, type Action } from "./panel";
import { Trial } from "./pulses";
import { foundTables, motorInWords } from "./result";
import { Rules } from "./rules";
import { AGAIN, FIRST, SECOND, stepInGroup, stepTitle, THIRD, type Step } from "./step";
import { Walk, type Found } from "./walk";
import { jointTitle, motorsAsked, poseAsked, poseInWords } from "./words";

const DEGREE = Math.PI / 180;
const SECOND_DEG = [60, 50, -45, 40]; // far enough from 0 at every joint
const THIRD_RAD = [-35, -20, 30, -40].map((angle) => DEGREE * angle); // of the bench's hands
const BY_HANDS = "This arm is simulated, and its hands can do each step for you. First break something in Bench, such as a reversed potentiometer "
  + "or motor: it is found here and put right.";
const NOT_TRIED = "The motors were not tried: Stop was pressed, or the page was hidden.";
const STOPPED = "Stop was pressed; the other motors were not tried.";
const NO_RULES = "This page came without the rules of a calibration; run `make setup` and reload it, or `greywhale calibrate` in a terminal.";

export class CalibrateView implements View {
  readonly name = "Calibrate";
  readonly element: HTMLElement;
  private rules: Rules | null = null;
  private walk: Walk | null = null;
  private angles: number[][] = [[0, 0, 0, 0], SECOND_DEG]; // of the known poses, degrees
  private known = true; // the second pose's angles are
  private mends = false; // a sweep with a mistake is to be done again
  private stored: Found | null = null; // to be undone
  private readonly panel: StepPanel;
  private readonly hands: Hands | null;
  private readonly bars: PotBars;
  private readonly list = el("div", { class: "steps", attrs: { role: "group", "aria-label": "Steps" } });
  private readonly picture = el("div", { class: "joint-picture", hidden: true, attrs: { role: "img" } });

  /** `code` brings the rules of a calibration, once they are asked for; `bench` has hands, where the arm is simulated. */
  constructor(
    private readonly session: Session, private readonly code: () => Promise<ArrayBuffer>,
    private readonly countdown: Pick<Countdown, "before">, private readonly kept: Calibrations, bench: Bench | null = null,
  ) {
    this.hands = bench && new Hands(session, bench);
    this.panel = new StepPanel(session);
    this.bars = new PotBars(session);
    this.element = el("div", { class: "editor calibrate" },
      el("section", { class: "card" }, el("h2", {}, "Calibrate"), this.list, ...this.panel.elements, this.picture),
      el("section", { class: "card" }, el("h2", {}, "Potentiometers"), this.bars.element,
        el("p", { class: "quiet" }, `Counts of ${FULL_SCALE}, and degrees where the board is calibrated.`)));
    session.changed.on(() => this.panel.refresh());
    this.showBeginning();
  }

  enter(): void {
    void this.panel.attempt(async () => {
      await this.session.readParameters();
      await this.showEarlier();
    });
  }

  leave(): void {
    this.panel.forgetFocus();
    this.hands?.letGo();
  }

  frame(): void {
    this.bars.frame();
    this.panel.refresh();
  }

  // --- the way ------------------------------------------------------------------------------------------------------

  private showPanel(title: string, asked: string, body: readonly HTMLElement[], actions: readonly Action[]): void {
    this.panel.show(title, asked, body, actions, this.stepButtons());
  }

  private stepButtons(): Action[] {
    const { walk } = this;
    this.list.hidden = !walk;
    const groups = new Map<string, HTMLElement>();
    const actions = (walk?.steps ?? []).map((step, at) => {
      const title = stepTitle(step);
      const [group, short] = stepInGroup(step);
      const one = this.panel.action(short, async () => this.go(at), `Go to this step: ${title}`, false, () => this.panel.whyNot() || walk!.whyNot(at));
      one.button.setAttribute("aria-label", walk!.isDone(step) ? `${title}, done` : title);
      one.button.dataset["done"] = String(walk!.isDone(step));
      if (at === walk!.at) one.button.setAttribute("aria-current", "step");
      if (!groups.has(group)) groups.set(group, el("div", {}, el("span", { class: "quiet" }, group)));
      groups.get(group)!.append(one.button);
      return one;
    });
    this.list.replaceChildren(...groups.values());
    return actions;
  }

  private showBeginning(said = ""): void {
    this.walk = null;
    this.picture.hidden = true;
    this.bars.ask([]);
    const scale = potParameter(0, "scale");
    const track = el("input", { type: "number", value: fixed(scale.initial * scale.lsb * FULL_SCALE * COUNT14_PER_COUNT / DEGREE, 0),
      attrs: { step: "any", "aria-label": "The tracks' length, degrees" } });
    const length = el("label", { class: "row", hidden: true }, "The tracks' length, degrees", track);
    const second = select("Second pose", [["known", "I can set angles that I know"], ["same", "I have no protractor: any pose, the same for both arms"]],
      (choice) => { length.hidden = choice !== "same"; });
    this.showPanel("By hand, with the motors off",
      said || "Turn each joint of both arms to its ends, hold four poses, then each motor gets some weak pulses: five minutes. Nothing is stored before you agree.", [
        el("label", { class: "row" }, "Second pose", second), length,
        el("p", { class: "quiet" }, this.hands ? BY_HANDS : "Only joints in use are asked for; `greywhale calibrate --joints` in a terminal changes which those are."),
      ], [
        this.panel.action("Begin", () => this.begin(second.value === "same" ? DEGREE * Number(track.value) : null), "Begin with the first sweep", true),
        ...(this.stored ? [this.panel.action("Undo", () => this.undo(), "Run and store the parameters from before this calibration")] : []),
      ]);
    void this.panel.attempt(() => this.showEarlier());
  }

  /** Below the beginning, if any was kept. */
  private async showEarlier(): Promise<void> {
    if (this.walk || !this.session.link.open) return;
    const found = await this.kept.list();
    if (this.walk || !found.length) return;
    const usual = "Run and store it; controllers and everything else stay";
    const list = earlierList(found, (one) => void this.panel.attempt(() => this.goBack(one)), (made) => {
      this.panel.add({ button: made, whyNot: () => this.panel.whyNot(), usual });
    });
    this.panel.body.querySelector(".earlier")?.remove();
    this.panel.body.append(list);
    this.panel.refresh();
  }

  private async goBack(one: KeptCalibration): Promise<void> {
    const before = await this.session.readParameters();
    await this.storeKept(before, withCalibration(before, one), "back");
    this.stored = null;
    this.showBeginning(`The board runs and keeps calibration ${one.number} again.`);
  }

  /** Runs and stores a set, and keeps the calibrations before and after. */
  private async storeKept(before: readonly number[], after: readonly number[], why: "page" | "back"): Promise<void> {
    await this.panel.alone("The board stores it.", async () => {
      const { board } = this.session.hello!;
      await this.kept.keep(before, board, "found");
      await this.session.apply(after);
      await this.session.store();
      await this.kept.keep(after, board, why);
    });
  }

  private async begin(track: number | null): Promise<void> {
    await this.panel.alone("The rules are on their way.", async () => {
      this.rules ??= await Rules.load(await this.code().catch(() => { throw new LinkError(NO_RULES); }));
      this.walk = new Walk(this.session, this.rules, await this.session.readParameters(), track);
      this.known = track === null;
    });
    this.go(0);
  }

  private go(at: number): void {
    this.walk!.go(at);
    this.showStep();
  }

  private showStep(): void {
    this.hands?.letGo();
    this.mends = false;
    const { step, joints } = this.walk!;
    this.picture.hidden = step.kind !== "sweep";
    this.bars.ask(step.kind === "sweep" ? [step.pot] : step.kind === "pose" ? potsOf(joints) : []);
    if (step.kind === "sweep") this.showSweep(step.pot);
    else if (step.kind === "pose") this.showPose(step.place);
    else if (step.kind === "motors") this.showMotors();
    else void this.panel.attempt(() => this.showFound());
  }

  /** "Back", and the same step again. */
  private ways(): Action[] {
    const { at } = this.walk!;
    return [
      this.panel.action("Again", async () => this.go(at), "Begin this step anew"),
      this.panel.action("Back", async () => (at ? this.go(at - 1) : this.showBeginning()), "The step before"),
    ];
  }

  /** What the bench's hands do in a step, and then the step is done. */
  private byHands(label: string, wish: () => HandsWish, done: () => Promise<void>, usual: string): Action[] {
    const { hands, walk } = this;
    return hands ? [this.panel.action(label, async () => {
      if (hands.areBusy && !this.mends) return; // a second press would begin anew
      if (this.mends) this.go(walk!.at);
      const going = hands.do(wish());
      this.panel.ask("The bench's hands do it.");
      if (await going) await this.panel.attempt(done);
    }, usual)] : [];
  }

  private place(step: Step): string {
    const alike = this.walk!.steps.filter(({ kind }) => kind === step.kind);
    return `${alike.indexOf(step) + 1} of ${alike.length}`;
  }

  private showSweep(pot: number): void {
    const { walk, rules } = this;
    const pots = potsOf(walk!.joints);
    const wrong = pots[(pots.indexOf(pot) + 1) % pots.length]!;
    const joint = String(pot % JOINTS);
    this.picture.dataset["joint"] = joint;
    this.picture.setAttribute("aria-label", `The positive way of joint ${joint}`);
    const done = (): Promise<void> => this.endSweep(pot);
    this.showPanel(`Sweep ${this.place(walk!.step)}: ${jointTitle(pot)}`, upperFirst(rules!.turnAsked(pot % JOINTS)), [], [
      this.panel.action("Done", done, "The joint was turned to both ends", true),
      ...this.ways(),
      this.panel.action("Later", async () => {
        walk!.later();
        this.showStep();
      }, "Put this sweep behind the others"),
      ...this.byHands("Let the bench's hands do it", () => ({ turn: pot }), done, "They turn this joint to both ends"),
      ...this.byHands("Let them turn a wrong joint", () => ({ turn: wrong }), done, "To see how a mistake is told"),
    ]);
  }

  /** Ends a sweep, or begins it again where a mistake was mended. */
  private async endSweep(pot: number): Promise<void> {
    const walk = this.walk!;
    if (this.mends) return this.go(walk.at);
    let mistake = "";
    await this.panel.alone("The sweep is looked at.", async () => { mistake = await walk.takeSweep(pot); });
    if (!mistake) return this.goOn();
    this.hands?.letGo();
    this.mends = true;
    this.panel.tell(mistake);
    this.panel.ask("Mend it, or turn the right joint; then comes this sweep again.");
    this.panel.offerAgain();
  }

  private goOn(): void {
    this.walk!.next();
    this.showStep();
  }

  private showPose(place: number): void {
    const walk = this.walk!;
    const asksAngles = place === FIRST || (place === SECOND && this.known);
    const given = (pose: number): number[] => this.angles[pose]!.map((angle) => DEGREE * angle);
    const inputs = asksAngles ? walk.joints.map((joint) => {
      const input = el("input", { type: "number", value: String(this.angles[place]![joint]), attrs: { step: "any", "aria-label": `Joint ${joint}, degrees` } });
      input.addEventListener("change", () => {
        this.angles = this.angles.map((pose, one) => (one === place ? pose.map((angle, of) => (of === joint ? Number(input.value) : angle)) : pose));
      });
      return el("label", { class: "factor" }, `${joint} ${JOINT_NAMES[joint]!}, degrees`, input);
    }) : [];
    const done = async (): Promise<void> => {
      await this.panel.alone("The pose is looked at.", () => walk.takePose(place, given(Math.min(place, SECOND))));
      this.goOn();
    };
    const held = (): number[] => (place === THIRD ? THIRD_RAD : given(place === AGAIN ? FIRST : place));
    this.showPanel(`Pose ${this.place(walk.step)}: ${stepTitle(walk.step)}`, poseAsked(place, poseInWords(given(FIRST), walk.joints), this.known),
      inputs.length ? [el("div", { class: "factors" }, ...inputs)] : [], [
        this.panel.action("Take the pose", done, "Both arms are held still in it", true),
        this.ways()[1]!,
        ...this.byHands("Let the bench's hands do it", () => ({ pose: held() }), done, "They hold both arms in this pose"),
      ]);
  }

  // --- motors, and the end ------------------------------------------------------------------------------------------

  private showMotors(): void {
    const walk = this.walk!;
    const supply = this.session.parameters![TABLE.named("supply_mv").index]! / 1000;
    const tried = [...walk.motors.values()];
    const results = walk.joints.map((joint) => el("li", {}, el("span", {}, `${joint} ${JOINT_NAMES[joint]!}`), el("span", {}, motorInWords(walk.motors.get(joint)))));
    const pulses = (): Promise<void> => this.tryMotors();
    this.showPanel("Motors", motorsAsked(this.rules!, supply), [
      el("ul", { class: "differences", attrs: { "aria-label": "Motors" } }, ...results),
      el("p", { class: "problem" }, this.rules!.remarks(tried, supply)),
    ], walk.isDone(walk.step) ? [
      this.panel.action("Go on", async () => this.goOn(), "See what was found", true),
      this.panel.action("Try them again", async () => {
        walk.motors.clear();
        walk.motorsLeft = false;
        this.showMotors();
      }, "All motors get pulses again"),
      this.ways()[1]!,
    ] : [
      this.panel.action(tried.length ? "Try the other motors" : "Try the motors", pulses, "Each gets short weak pulses, after a countdown", true),
      this.panel.action("Leave the motors as they are", async () => {
        walk.motorsLeft = true;
        this.goOn();
      }, "Their directions stay; nothing moves"),
      this.ways()[1]!,
      ...this.byHands("Let the bench's hands let it hang", () => ({ hang: true }), pulses, "The follower hangs, and each motor gets short weak pulses"),
    ]);
  }

  private async tryMotors(): Promise<void> {
    const { walk, session, rules } = this;
    try {
      await this.panel.alone("The motors get pulses; Stop ends them.", async () => {
        if (!await this.countdown.before("The arm is about to get pulses of its motors")) throw new LinkError(NOT_TRIED);
        let stops = session.stopsAsked; // with those by which a trial itself ends
        for (const joint of walk!.joints.filter((one) => !walk!.motors.has(one))) {
          this.panel.ask(`Motor ${walk!.joints.indexOf(joint) + 1} of ${walk!.joints.length}, joint ${joint}, ${JOINT_NAMES[joint]!}, gets pulses.`);
          const { before, after } = await walk!.found();
          if (session.stopsAsked !== stops) throw new LinkError(STOPPED);
          walk!.motors.set(joint, await new Trial(session, rules!, before, after, joint).run());
          stops++;
        }
      });
    } finally {
      if (this.walk === walk) this.showMotors();
    }
  }

  private async showFound(): Promise<void> {
    const walk = this.walk!;
    const found = await walk.found();
    this.showPanel("Store this?", "What was found neither runs nor is stored yet.", [foundTables(found, walk.joints, walk.motors)], [
      this.panel.action("Yes, store it", () => this.store(found), "Run it, and write it to the board's memory", true),
      this.panel.action("No", async () => this.showBeginning("Nothing was stored."), "Keep what runs"),
      this.ways()[1]!,
    ]);
  }

  private async store(found: Found): Promise<void> {
    await this.storeKept(found.before, found.after, "page");
    this.stored = found;
    this.showBeginning();
    this.showPanel("Stored", "The board is calibrated. An arm file needs these potentiometers too: greywhale arm match arm.toml", [], [
      this.panel.action("Undo", () => this.undo(), "Run and store the parameters from before"),
      this.panel.action("Save the parameters from before", async () => download("before-calibration.toml", parameterFile(found.before), "application/toml"),
        "As a file that greywhale params restore takes", false, () => ""),
      this.panel.action("Calibrate again", async () => this.showBeginning(), "Begin anew"),
    ]);
  }

  private async undo(): Promise<void> {
    const { before, after } = this.stored!;
    await this.storeKept(after, before, "back");
    this.stored = null;
    this.showBeginning("The parameters from before run and are stored again.");
  }
}
