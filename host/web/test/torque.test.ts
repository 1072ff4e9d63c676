// Torques from outside as a person reads and hears them.
import assert from "node:assert/strict";
import { test } from "node:test";
import { Tones } from "../src/parts/tones";
import { contactText, torqueText } from "../src/views/live/torque_words";

const joint = { torque_nm: 0.4249, half_width_nm: 0.05, why: "", contact: false, share: 0.2 };

test("a joint's torque has its interval, or the reason why it cannot be told, and a contact goes before both", () => {
  assert.equal(torqueText(joint), "+0.42 ±0.05");
  assert.equal(torqueText({ ...joint, why: "at rest" }), "at rest");
  assert.equal(torqueText({ ...joint, torque_nm: -1, why: "at rest", contact: true }), "contact -1.00");
});

test("a contact is told when it begins and when it has ended", () => {
  const contact = { joint: 1, tick: 12_340, torque_nm: -0.5, lasted_s: 0.31, lasts: true };
  assert.equal(contactText(contact, 12.34), "Contact: joint 1 at 12.34 s.");
  assert.equal(contactText({ ...contact, lasts: false }, 12.34), "Last contact: joint 1 at 12.34 s, up to -0.50 N m, for 0.31 s.");
});

/** A browser's sound that keeps what was played. */
class Sound {
  state = "suspended";
  currentTime = 0;
  readonly destination = {};
  readonly played: { hz: number; loudest: number; from: number; to: number }[] = [];
  private loudest = 0;

  async resume(): Promise<void> {
    this.state = "running";
  }

  createGain(): object {
    this.loudest = 0;
    const gain = { setValueAtTime: () => undefined, linearRampToValueAtTime: (to: number) => { this.loudest = Math.max(this.loudest, to); } };
    return { gain, connect: (next: unknown) => next };
  }

  createOscillator(): object {
    const tone = {
      frequency: { value: 0 }, connect: (next: unknown) => next,
      start: (from: number) => this.played.push({ hz: tone.frequency.value, loudest: this.loudest, from, to: NaN }),
      stop: (to: number) => { this.played.at(-1)!.to = to; },
    };
    return tone;
  }
}

test("nothing sounds before a press; then each joint has its pitch, a larger torque is louder, and tones of one joint are apart", () => {
  const sound = new Sound();
  const tones = new Tones(() => sound as unknown as AudioContext);
  tones.play(0, 1);
  assert.equal(tones.allowed, false);
  tones.allow();
  for (const [joint, share, at] of [[0, 0.1, 1], [0, 0.1, 1.1], [2, 0.4, 1.1], [0, 5, 1.3]] as const) {
    sound.currentTime = at;
    tones.play(joint, share);
  }
  assert.deepEqual(sound.played.map(({ from }) => from), [1, 1.1, 1.3]);
  assert.ok(sound.played.every(({ from, to }) => to - from < 0.2));
  const [first, other, again] = sound.played;
  assert.equal(first!.hz, again!.hz);
  assert.notEqual(first!.hz, other!.hz);
  assert.ok(first!.loudest < other!.loudest && other!.loudest < again!.loudest && again!.loudest <= 1);
});
