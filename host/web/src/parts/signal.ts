// Tells listeners that something has changed; they look for themselves at what.

export class Signal {
  private readonly listeners = new Set<() => void>();

  /** Calls the listener from now on at each change. */
  on(listener: () => void): void {
    this.listeners.add(listener);
  }

  emit(): void {
    for (const listener of this.listeners) listener();
  }
}
