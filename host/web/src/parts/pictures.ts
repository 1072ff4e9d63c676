// Times the page's drawing: once for each picture of the screen, where that is quick.

const A_PICTURE_MS = 17; // of a screen of 60 Hz

/** A screen, and its time in ms. */
export type Screen = {
  now(): number;
  /** Calls once, before the next picture is painted. */
  next(act: () => void): void;
  /** Calls once, when this picture is painted. */
  painted(act: () => void): void;
};

const SCREEN: Screen = {
  now: () => performance.now(),
  next: (act) => void requestAnimationFrame(act),
  painted: (act) => void setTimeout(act),
};

/**
 * Draws from now on. Where a picture takes long, as in software, the page rests as long before the next one: what it hears
 * and says meanwhile, above all that it is there, must not wait.
 */
export function drawPictures(draw: () => void, screen = SCREEN): void {
  let restsUntil = 0; // ms
  const picture = (): void => {
    screen.next(picture);
    const begun = screen.now();
    if (begun < restsUntil) return;
    draw();
    screen.painted(() => {
      const end = screen.now();
      restsUntil = end - begun > A_PICTURE_MS ? 2 * end - begun : 0;
    });
  };
  screen.next(picture);
}
