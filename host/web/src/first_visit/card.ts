// A card with one thing to try: a button that does it and takes it back, and what just happened once it was done.

import { button, el, setText } from "../parts/dom";

export type Words = {
  readonly title: string;
  readonly hint: string;
  readonly act: string;
  /** What takes it back; the act itself where nothing does. */
  readonly back: string;
  readonly happened: string;
  readonly more: readonly [page: string, title: string];
};

export class Card {
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
