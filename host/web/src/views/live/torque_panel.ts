// Torques from outside, as an identified model tells them: a row a joint, lit while something touches it, and a tone if wished.

import { TABLE } from "../../link/schema";
import { button, el, select, setText } from "../../parts/dom";
import { showReason } from "../../parts/grey";
import { browserStore } from "../../parts/storage";
import { Tones } from "../../parts/tones";
import { JOINT_NAMES, TICKS_A_SECOND } from "../../session/samples";
import type { ContactNow, OutsideTorque, Services } from "../../session/services";
import type { Session } from "../../session/session";
import { contactText, torqueText } from "./torque_words";

const FILTER_SHIFT = TABLE.named("filter_shift").index;
const SOUND = "greywhale-sound"; // the key of what a person chose
const EVERY_MS = 200; // numbers are read no quicker; a contact is shown at once
const SILENT_MS = 1000; // after which the last torques are no longer those of now

export class TorquePanel {
  readonly element: HTMLElement;
  private readonly cells = JOINT_NAMES.map(() => el("td", {}, "–"));
  private readonly rows = this.cells.map((cell, joint) => el("tr", {},
    el("th", { attrs: { scope: "row" } }, el("span", { class: `key key-${joint}` }), ` ${joint} `, el("span", { class: "wide" }, JOINT_NAMES[joint]!)), cell));
  private readonly last = el("p", { attrs: { "aria-live": "polite" } });
  private readonly problem = el("p", { class: "problem", attrs: { role: "status" } });
  private readonly choice = select<string>("Model", [], () => this.follow());
  private readonly by = el("label", { class: "row" }, el("span", { class: "quiet" }, "By"), this.choice);
  private readonly sound = button("Sound", () => this.switchSound(), { title: "A tone at each contact: its pitch tells the joint, its loudness the torque" });
  private readonly silent = el("p", { class: "reason", hidden: true });
  private sounds = browserStore.read(SOUND) === "on";
  private newest: OutsideTorque | null = null;
  private heardAt = 0;
  private shownAt = 0;
  private followed = "";
  private end = (): void => undefined;

  constructor(
    private readonly session: Session, private readonly services: Pick<Services, "predictor" | "torques">,
    private readonly tones = new Tones(),
  ) {
    this.element = el("section", { class: "card torque", hidden: true },
      el("h2", {}, "Torque from outside ", el("span", { class: "unit" }, "N m")), this.problem,
      el("table", {}, el("tbody", {}, ...this.rows)), this.last, el("div", { class: "row" }, this.sound, this.by), this.silent);
    for (const press of ["click", "keydown"]) addEventListener(press, () => { if (this.sounds) this.tones.allow(); });
  }

  /** Looks for models; without any there is no card. */
  enter(): void {
    void this.session.attempt(async () => {
      const names = (await this.services.predictor.models()).filter(({ identified }) => identified).map(({ name }) => name);
      const before = this.choice.value;
      this.choice.replaceChildren(...names.map((name) => el("option", { value: name }, name)));
      if (names.includes(before)) this.choice.value = before;
      this.element.hidden = !names.length;
    });
  }

  leave(): void {
    this.end();
    this.end = () => undefined;
    this.followed = "";
  }

  frame(): void {
    this.follow();
    const now = performance.now();
    if (now > this.heardAt + SILENT_MS) this.newest = null;
    if (!this.newest || now > this.shownAt + EVERY_MS) this.show();
    this.sound.setAttribute("aria-pressed", String(this.sounds));
    showReason(this.silent, this.sounds && !this.tones.allowed ? "Click anywhere: a browser lets a page sound only then." : "");
  }

  /** Listens, by the model that is chosen and by the board's filter, once both are known. */
  private follow(): void {
    const model = this.choice.value;
    const shift = this.session.parameters?.[FILTER_SHIFT];
    const wanted = `${shift} ${model}`;
    if (!model || shift === undefined || wanted === this.followed) return;
    this.leave();
    this.followed = wanted;
    setText(this.problem, "");
    this.end = this.services.torques.listen(model, shift, (told) => this.heard(told), (sentence) => setText(this.problem, sentence));
  }

  private heard(told: OutsideTorque): void {
    const before = this.newest;
    this.newest = told;
    this.heardAt = performance.now();
    if (told.joints.some(({ contact }, joint) => contact !== (before?.joints[joint]?.contact ?? false))) this.show();
    if (told.contact && !isSame(told.contact, before?.contact ?? null)) this.tell(told.contact);
    if (this.sounds) told.joints.forEach(({ contact, share }, joint) => { if (contact) this.tones.play(joint, share); });
  }

  private show(): void {
    this.shownAt = performance.now();
    this.rows.forEach((row, joint) => {
      const now = this.newest?.joints[joint];
      row.dataset["contact"] = now?.contact ? "yes" : "";
      setText(this.cells[joint]!, now ? torqueText(now) : "–");
    });
  }

  /** Says it by the clock of the charts, which goes on where the board starts anew; once, so that nobody is read to without end. */
  private tell(contact: ContactNow): void {
    const { lastTime, lastTick } = this.session.samples;
    setText(this.last, contactText(contact, (contact.tick + lastTime - lastTick) / TICKS_A_SECOND));
  }

  private switchSound(): void {
    this.sounds = !this.sounds;
    browserStore.write(SOUND, this.sounds ? "on" : "off");
    if (this.sounds) this.tones.allow();
  }
}

function isSame(one: ContactNow, other: ContactNow | null): boolean {
  return one.joint === other?.joint && one.tick === other.tick && one.lasts === other.lasts;
}
