// A person's drawing for one joint: an angle at each column of a picture, where something is drawn.

export class Stroke {
  /** Angles in the order of the columns; null where nothing is drawn yet. */
  readonly angles: (number | null)[];
  private last: number | null = null; // column of the pen, while it is down

  constructor(private readonly columns: number) {
    this.angles = new Array<number | null>(columns).fill(null);
  }

  get empty(): boolean {
    return this.angles.every((angle) => angle === null);
  }

  lift(): void {
    this.last = null;
  }

  clear(): void {
    this.angles.fill(null);
    this.lift();
  }

  /** Draws a straight line from where the pen is; `share` is the place between the first column and the last. */
  drawTo(share: number, angle: number): void {
    const column = Math.round(share * (this.columns - 1));
    const from = this.last ?? column;
    const first = this.last === null ? angle : this.angles[from]!;
    for (let at = Math.min(from, column); at <= Math.max(from, column); at++) {
      this.angles[at] = from === column ? angle : first + ((angle - first) * (at - from)) / (column - from);
    }
    this.last = column;
  }

  /** The drawn angle nearest to a place; null where nothing is drawn. */
  at(share: number): number | null {
    const column = share * (this.columns - 1);
    let nearest: number | null = null;
    let distance = Infinity;
    this.angles.forEach((angle, at) => {
      if (angle !== null && Math.abs(at - column) < distance) [nearest, distance] = [angle, Math.abs(at - column)];
    });
    return nearest;
  }
}
