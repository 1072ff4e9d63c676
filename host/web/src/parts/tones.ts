// Short tones, one pitch a joint, as loud as the torque. A browser lets a page sound only after somebody has pressed something.

const PITCHES_HZ = [330, 440, 587, 784]; // far enough apart to be told by ear
const LASTS_S = 0.12;
const RISES_S = 0.008; // at once it would click
const AGAIN_S = 0.25; // from one tone to the next of the same joint
const FULL_SHARE = 0.5; // of the stall torque is as loud as it gets
const LOUDEST = 0.5, SOFTEST = 0.06; // of all that the loudspeaker can

export class Tones {
  private context: AudioContext | null = null;
  private readonly begun = new Array<number>(PITCHES_HZ.length).fill(-Infinity);

  constructor(private readonly make: () => AudioContext = () => new AudioContext()) {}

  /** True if a tone would be heard now. */
  get allowed(): boolean {
    return this.context?.state === "running";
  }

  /** Gets ready to sound; to be called while somebody presses something. */
  allow(): void {
    this.context ??= this.make();
    if (!this.allowed) void this.context.resume();
  }

  /** Sounds the tone of a joint, `share` of its motor's stall torque loud, unless its last one is too fresh. */
  play(joint: number, share: number): void {
    const { context } = this;
    if (!context || !this.allowed || context.currentTime < this.begun[joint]! + AGAIN_S) return;
    const now = context.currentTime;
    this.begun[joint] = now;
    const loudness = context.createGain();
    loudness.gain.setValueAtTime(0, now);
    loudness.gain.linearRampToValueAtTime(Math.max(SOFTEST, LOUDEST * Math.min(1, share / FULL_SHARE)), now + RISES_S);
    loudness.gain.linearRampToValueAtTime(0, now + LASTS_S);
    const tone = context.createOscillator();
    tone.type = "triangle";
    tone.frequency.value = PITCHES_HZ[joint]!;
    tone.connect(loudness).connect(context.destination);
    tone.start(now);
    tone.stop(now + LASTS_S);
  }
}
