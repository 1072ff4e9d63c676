// All that the page keeps in the browser goes through here. A browser may forbid it, so that the access alone throws, have
// none, or be full: reads then give null, and writes false. Nothing throws.

export class Store {
  constructor(private readonly open: () => Storage | null) {}

  /** True if the browser lets this page keep anything at all. */
  get allowed(): boolean {
    return attempt(() => this.opened().getItem("") !== undefined, false);
  }

  read(key: string): string | null {
    return attempt(() => this.opened().getItem(key), null);
  }

  /** True if it is kept. */
  write(key: string, text: string): boolean {
    return attempt(() => {
      this.opened().setItem(key, text);
      return true;
    }, false);
  }

  /** Gives a text another key; without room for that it stays where it is. */
  move(from: string, to: string): boolean {
    const text = this.read(from);
    if (text === null) return false;
    if (this.write(to, text)) return this.remove(from);
    const room = this.remove(from); // two of them were too much
    if (room && this.write(to, text)) return true;
    this.write(from, text);
    return false;
  }

  private remove(key: string): boolean {
    return attempt(() => {
      this.opened().removeItem(key);
      return true;
    }, false);
  }

  private opened(): Storage {
    const storage = this.open();
    if (!storage) throw new Error("no storage");
    return storage;
  }
}

function attempt<Value>(act: () => Value, otherwise: Value): Value {
  try {
    return act();
  } catch {
    return otherwise;
  }
}

/** Storage that stays until the person clears it. */
export const browserStore = new Store(() => localStorage);
/** Storage that stays as long as this tab. */
export const tabStore = new Store(() => sessionStorage);
