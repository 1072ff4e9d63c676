// From potentiometers mounted anyhow to angles, by hand: a sweep of each joint, four poses, and pulses of the
// motors; mistakes of the wiring by name.

import { fixed } from "../../files/words";
import { LinkError } from "../../link/declared";
import { potName, upperFirst } from "../../link/refusal";
import { State, TABLE } from "../../link/schema";
import { button, el, setText, tableHead } from "../../parts/dom";
import type { View } from "../view";
import { JOINTS, traceOf } from "../../session/samples";
import type { Session } from "../../session/session";
import { Trial } from "./pulses";
import { jointsInUse, potsOf, Rules, type Calibration, type Motor, type Pose, type Sweep } from "./rules";
import { motorsAsked, POSES, POSES_ASKED, sweepAsked } from "./words";

const POTS = Array.from({ length: 2 * JOINTS }, (_, pot) => pot);
const HELD_TICKS = 500; // that a pose is looked at
const SECOND_RAD = 1;
const [FIRST, SECOND, AGAIN, THIRD] = [0, 1, 2, 3] as const;

export class CalibrateView implements View {
  readonly name = "Calibrate";
  readonly element: HTMLElement;
  private readonly sweeps: (Sweep | null)[] = POTS.map(() => null);
  private turning: { readonly pot: number; readonly from: number } | null = null; // since that sample
  private poses: (Pose | null)[] = POSES.map(() => null);
  private rules: Rules | null = null;
  private readonly motors = new Map<number, Motor>(); // that have turned since something was stored
  private readonly ready = el("p");
  private readonly turned = el("p", { attrs: { role: "status" } });
  private readonly next = button("Begin the sweeps", () => this.act((rules) => this.goOn(rules)), { class: "primary" });
  private readonly asked = el("p", { attrs: { role: "status" } }, "The motors stay off. Turn one joint of one arm after the other.");
  private readonly said = el("p", { attrs: { role: "status" } });
  private readonly rows = POTS.map((pot) => ({
    cells: ["", "", ""].map((text) => el("td", {}, text)),
    sweep: button("Begin", () => this.act((rules) => this.begin(rules, pot)), { title: `Sweep the joint of the ${potName(pot)}` }),
  }));

  /** `code` brings the rules of a calibration, once they are asked for. */
  constructor(private readonly session: Session, private readonly code: () => Promise<ArrayBuffer>) {
    const head = tableHead("potentiometer", "reads", "least", "most", "sweep");
    const rows = this.rows.map(({ cells, sweep }, pot) => el("tr", {},
      el("th", { attrs: { scope: "row" } }, upperFirst(potName(pot)).replace(" potentiometer", "")), ...cells, el("td", {}, sweep)));
    this.element = el("div", { class: "editor" },
      el("section", { class: "card" },
        el("h2", {}, "1 Sweeps"), this.asked, el("div", { class: "row" }, this.next),
        el("table", {}, head, el("tbody", {}, ...rows)),
        el("p", { class: "quiet" }, "Counts of 1023. Each sweep shows whether the right potentiometer turns, and it alone.")),
      el("section", { class: "card connect" },
        ...POSES.flatMap((_, place) => this.pose(place)),
        el("h2", {}, "6 Motors"), this.ready,
        el("div", { class: "row" }, ...[0, 1, 2, 3].map((joint) => button(`Try motor ${joint}`, () => this.act((rules) => this.tryMotor(rules, joint))))), this.turned,
        el("h2", {}, "7 Store"),
        el("div", { class: "row" }, button("Store", () => this.act((rules) => this.store(rules)), { class: "primary", title: "Run and store what was found" })),
        this.said,
        el("p", { class: "quiet" }, "Motors that were not tried keep their directions. greywhale calibrate also compares the arms without a protractor.")));
  }

  private pose(place: number): HTMLElement[] {
    const title = POSES[place]!;
    const inputs = place > SECOND ? [] : Array.from({ length: JOINTS }, (_, joint) =>
      el("input", { type: "number", value: String(place * SECOND_RAD), attrs: { step: "any", "aria-label": `${title}, joint ${joint}, rad` } }));
    const take = button(`Take the ${title.toLowerCase()}`, () => this.act(async (rules) => {
      const raw = await this.running();
      const angles = place === AGAIN ? this.poses[FIRST]?.angles ?? [] : inputs.map(({ value }) => Number(value));
      this.take(rules, place, { angles, counts: this.still(rules, raw) }, jointsInUse(raw));
    }));
    return [el("h2", {}, `${place + 2} ${title}`), el("p", {}, POSES_ASKED[place]!), el("div", { class: "row" }, ...inputs, take)];
  }

  private act(act: (rules: Rules) => Promise<void>): void {
    void this.session.attempt(async () => act(await this.load()));
  }

  private async load(): Promise<Rules> {
    if (!this.rules) {
      const rules = await Rules.load(await this.code());
      setText(this.ready, motorsAsked(rules));
      this.rules = rules;
    }
    return this.rules;
  }

  enter(): void {
    this.act(async () => undefined);
  }

  /** The set that runs, by which the counts are known; the motors must be off. */
  private async running(): Promise<readonly number[]> {
    if (this.session.motorsOn || this.session.state === State.is.boot) throw new LinkError("Calibrate with the motors off; press Stop first.");
    return this.session.readParameters();
  }

  /** Ends the sweep that is under way, and begins the next. */
  private async goOn(rules: Rules): Promise<void> {
    const raw = await this.running();
    const mistake = this.turning ? this.judge(rules, this.turning, raw) : "";
    const pot = potsOf(jointsInUse(raw)).find((one) => !this.sweeps[one]);
    if (!mistake && pot !== undefined) return this.begin(rules, pot);
    this.turning = null;
    this.next.hidden = !mistake;
    this.ask(mistake ? `${mistake} Mend it, then comes this sweep again.` : "All potentiometers turn with their joints.", mistake !== "");
  }

  private async begin(rules: Rules, pot: number): Promise<void> {
    if (!potsOf(jointsInUse(await this.running())).includes(pot)) throw new LinkError(`Joint ${pot % JOINTS} is not in use: a scale of it is 0.`);
    this.turning = { pot, from: this.session.samples.end };
    this.sweeps[pot] = null;
    this.next.hidden = false;
    this.ask(sweepAsked(rules, pot));
  }

  private ask(what: string, mistake = false): void {
    setText(this.asked, what);
    this.asked.classList.toggle("problem", mistake);
    this.show();
  }

  /** Keeps a sweep, or says what is wrong with it. */
  private judge(rules: Rules, { pot, from }: { readonly pot: number; readonly from: number }, raw: readonly number[]): string {
    this.requireOff(from);
    const { mistake, ...sweep } = rules.sweep(rules.counts(this.angles(from), raw), pot);
    if (!mistake) this.sweeps[pot] = sweep;
    return mistake;
  }

  /** With motors on, samples have the reference in the place of the leader. */
  private requireOff(from: number): void {
    const { samples } = this.session;
    for (let number = Math.max(from, samples.first); number < samples.end; number++) {
      const state = samples.state[number % samples.capacity];
      if (state === State.is.soft_start || state === State.is.following) throw new LinkError("The motors were on meanwhile; do it again with the motors off.");
    }
  }

  /** The angles in the samples from a number on, rows of eight. */
  private angles(from: number): number[] {
    const { samples } = this.session;
    const begin = Math.max(from, samples.first);
    if (begin >= samples.end) throw new LinkError("No sample has come yet; is the board silent?");
    return Array.from({ length: samples.end - begin }, (_, row) =>
      POTS.map((pot) => samples.count(begin + row, traceOf(pot < JOINTS ? "leader" : "follower", pot % JOINTS)))).flat();
  }

  /** The counts of arms that were held still. */
  private still(rules: Rules, raw: readonly number[]): readonly number[] {
    const { samples } = this.session;
    if (samples.end - samples.first < HELD_TICKS) throw new LinkError("There are too few samples yet; hold the pose for half a second.");
    this.requireOff(samples.end - HELD_TICKS);
    return rules.held(rules.counts(this.angles(samples.end - HELD_TICKS), raw));
  }

  /** Keeps a pose unless it contradicts what was before; those after it are to be taken again. */
  private take(rules: Rules, place: number, pose: Pose, joints: readonly number[]): void {
    const poses = this.poses.map((kept, one) => (one < place ? kept : one === place ? pose : null));
    const [first, , again] = poses;
    if (first && again) rules.requireNoSlip(first, again);
    const apart = this.solved(rules, poses, joints)?.apart;
    this.poses = poses;
    setText(this.said, `${POSES[place]} is taken.${apart ? ` The arms are ${fixed(1000 * Math.max(...apart), 0)} mrad apart in the third pose.` : ""}`);
  }

  /** The result of sweeps and poses, as soon as there are enough of them. */
  private solved(rules: Rules, poses: readonly (Pose | null)[], joints: readonly number[]): { found: Calibration; apart: readonly number[] | null } | null {
    const { [FIRST]: first, [SECOND]: second, [THIRD]: third } = poses;
    if (!first || !second || potsOf(joints).some((pot) => !this.sweeps[pot])) return null;
    const found = rules.solve(this.sweeps, first, second, joints);
    return { found, apart: third ? rules.apartIn(found, third, joints) : null };
  }

  /** The set that runs, and the same with potentiometers and limits as found. */
  private async calibrated(rules: Rules): Promise<{ readonly before: readonly number[]; readonly after: number[] }> {
    const before = await this.running();
    const joints = jointsInUse(before);
    const solved = this.solved(rules, this.poses, joints);
    if (!solved || this.poses.includes(null)) throw new LinkError("Take all sweeps and the four poses first.");
    const changes = rules.changesOf(solved.found, joints);
    return { before, after: TABLE.parameters.map(({ name, index }) => changes.get(name) ?? before[index]!) };
  }

  private async tryMotor(rules: Rules, joint: number): Promise<void> {
    const { before, after } = await this.calibrated(rules);
    if (!jointsInUse(before).includes(joint)) throw new LinkError(`Joint ${joint} is not in use: a scale of it is 0.`);
    const buttons = [...this.element.querySelectorAll("button")];
    for (const one of buttons) one.disabled = true;
    this.motors.delete(joint);
    setText(this.turned, `Motor ${joint} gets pulses.`);
    try {
      this.motors.set(joint, await new Trial(this.session, rules, before, after, joint).run());
    } finally {
      for (const one of buttons) one.disabled = false;
      const sentences = [...this.motors.values()].map(({ joint: one, volts, sign }) =>
        `Motor ${one}: ${fixed(volts, 1)} V moved it${sign < 0 ? ", the other way round; Store puts that right" : ""}.`);
      setText(this.turned, [...sentences, rules.remarks([...this.motors.values()], before[TABLE.named("supply_mv").index]! / 1000)].join(" "));
    }
  }

  private async store(rules: Rules): Promise<void> {
    const { after } = await this.calibrated(rules);
    for (const { joint, sign } of this.motors.values()) after[TABLE.named(`joint${joint}.motor_sign`).index]! *= sign;
    await this.session.apply(after);
    await this.session.store();
    this.motors.clear();
    setText(this.turned, "");
    setText(this.said, "What was found runs and is stored.");
  }

  private show(): void {
    setText(this.next, this.turning ? "Done" : "Go on");
    this.rows.forEach(({ cells, sweep }, pot) => {
      const { low, high } = this.sweeps[pot] ?? { low: NaN, high: NaN };
      [low, high].forEach((value, end) => setText(cells[end + 1]!, Number.isNaN(value) ? "–" : value.toFixed(1)));
      setText(sweep, this.turning?.pot === pot || this.sweeps[pot] ? "Again" : "Begin");
    });
  }

  frame(): void {
    const { rules, session: { samples, parameters } } = this;
    if (!rules || !parameters || !samples.end) return;
    rules.counts(this.angles(samples.end - 1), parameters).forEach((count, pot) => setText(this.rows[pot]!.cells[0]!, count.toFixed(1)));
  }
}
