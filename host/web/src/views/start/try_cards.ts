// Three things that a first visitor can try, and what just happened when one is tried.

import type { LeaderControl } from "../bench/leader_control";
import type { Bench } from "../../session/services";
import { RefusedError } from "../../link/declared";
import { button, el, setText } from "../../parts/dom";
import type { Session } from "../../session/session";

const SHOULDER = 1;
const PULLED_RAD = 0.7;
const WIRE = "pot-open:follower1";
const TRY_AGAIN_MS = 250;
const TRIES = 12; // until hands have brought both arms together again

type Words = {
  readonly title: string;
  readonly hint: string;
  readonly act: string;
  /** The button's words to take it back; those of the act where nothing does. */
  readonly back: string;
  readonly happened: string;
  readonly more: readonly [page: string, title: string];
};

const PULL: Words = {
  title: "Pull the leader",
  hint: "Drag the arm in the picture, or let this button pull its shoulder.",
  act: "Pull the shoulder",
  back: "Let it reach on",
  happened: "The board compares the leader's potentiometers with the follower's 1000 times a second, and drives each motor by the difference. So the follower goes wherever the leader is pulled.",
  more: ["fuzzy.html", "The controller"],
};
const BREAK: Words = {
  title: "Break a wire",
  hint: "The wire to the wiper of the follower's shoulder potentiometer comes off.",
  act: "Break the wire",
  back: "Mend it and go on",
  happened: "Without its wire the input reads 0 V, which no joint within its stops gives, so within three milliseconds the board turns all motors off, and a line above the arm names the potentiometer. They stay off until the wire is mended and somebody enables them again.",
  more: ["firmware.html#potentiometers-at-a-rail", "Potentiometers at a rail"],
};
const TUNE: Words = {
  title: "Let it tune",
  hint: "How hard a motor pulls is decided by fuzzy sets. A search finds better ones; you can also drag them while the arm moves.",
  act: "Let it tune",
  back: "Let it tune",
  happened: "Tune tries 500 sets of controllers on a simulation of this arm, and keeps those that follow a hand more closely without hunting. What it found runs once you press Apply.",
  more: ["in-the-browser.html#let-it-tune", "Let it tune"],
};

/** One thing to try: a button that does it and takes it back, and what just happened once it was done. */
class Card {
  readonly element = el("section", { class: "card try" });
  private readonly button = button("", () => void this.press());
  private readonly happened = el("p", { hidden: true, attrs: { role: "status" } });
  private done = false;
  private busy = false;

  /** `docs` is the folder of the documentation, null for none; `act` does it or takes it back, false where that failed. */
  constructor(private readonly words: Words, docs: string | null, private readonly act: (done: boolean) => Promise<boolean>) {
    const [page, title] = words.more;
    this.happened.append(words.happened, ...(docs ? [" ", el("a", { href: `${docs}${page}` }, title)] : []));
    this.element.append(el("h2", {}, words.title), el("p", { class: "quiet" }, words.hint), this.button, this.happened);
    this.show(false);
  }

  private async press(): Promise<void> {
    if (this.busy) return;
    this.busy = true;
    const done = !this.done || this.words.back === this.words.act;
    if (await this.act(done)) this.show(done);
    this.busy = false;
  }

  /** Shows whether it is done; what happened stays to be read. */
  show(done: boolean): void {
    this.done = done;
    if (done) this.happened.hidden = false;
    setText(this.button, done ? this.words.back : this.words.act);
  }
}

export class TryCards {
  readonly element = el("aside", { class: "side", attrs: { "aria-label": "Three things to try" } });
  private readonly pull: Card;

  /** `docs` is the folder of the documentation, null for none; `tune` shows where sets are tuned, and begins. */
  constructor(
    private readonly session: Session, private readonly bench: Bench, private readonly leaderControl: LeaderControl,
    docs: string | null, tune: () => Promise<void>,
  ) {
    const card = (words: Words, act: (done: boolean) => Promise<void>): Card =>
      new Card(words, docs, (done) => session.attempt(() => act(done)));
    this.pull = card(PULL, (pull) => (pull ? this.pullShoulder() : this.reach()));
    const wire = card(BREAK, (cut) => (cut ? bench.change({ fault: WIRE }) : this.mend()));
    const sets = card(TUNE, tune);
    this.element.append(this.pull.element, wire.element, sets.element);
  }

  private async pullShoulder(): Promise<void> {
    this.leaderControl.take(SHOULDER, PULLED_RAD);
  }

  private async reach(): Promise<void> {
    await this.bench.change({ motion: "reaches" });
    this.leaderControl.letGo();
  }

  private async mend(): Promise<void> {
    await this.bench.change({ fault: null });
    for (let left = TRIES; ; left--) {
      try {
        await this.session.clearFault();
        return await this.session.enable();
      } catch (error) {
        if (!left || !(error instanceof RefusedError)) throw error;
        await new Promise((resolve) => setTimeout(resolve, TRY_AGAIN_MS));
      }
    }
  }

  /** A person may have pulled it in the picture. */
  frame(): void {
    this.pull.show(this.leaderControl.leads);
  }
}
