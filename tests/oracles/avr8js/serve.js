// The board with a small arm on its pins, in real time at most: `node serve.js FIRMWARE.hex`. Its serial port is stdin
// and stdout; SIGUSR2 is the RESET pin. Leaders swing; a follower's speed follows its duty.
"use strict";

const { Nano, HZ } = require("./nano.js");

const PERIOD = HZ / 1000;
const VOLTS_PER_RAD = 0.955; // of the default table
const SWING_RAD = 0.3, SWING_HZ = 0.4;
const FULL_SPEED = 5, LAG_S = 0.03; // rad/s at a duty of 1, and how fast it is reached
const DRIVERS = 1 << 4; // PORTB

const nano = new Nano(process.argv[2]);
const joints = [0, 1, 2, 3].map(() => ({ leader: 0, follower: 0, speed: 0 }));
const out = [];

/** The signed duties -1..1 of the four motors. */
function duties() {
  const [a, b, c, d, portB, portD] = nano.outputs();
  if (!(portB & DRIVERS)) return [0, 0, 0, 0];
  const forward = [portD & 0x04, portD & 0x10, portD & 0x80, portB & 0x01];
  return [a / 400, b / 400, c / 255, d / 255].map((size, joint) => (forward[joint] ? size : -size));
}

function moveArm(timeS, stepS) {
  duties().forEach((duty, joint) => {
    const it = joints[joint];
    it.speed += ((duty * FULL_SPEED - it.speed) * stepS) / LAG_S;
    it.follower += it.speed * stepS;
    it.leader = SWING_RAD * Math.sin(2 * Math.PI * SWING_HZ * timeS + joint) - SWING_RAD * Math.sin(joint);
  });
}

nano.adc.voltage = (channel) => 2.5 + VOLTS_PER_RAD * joints[channel % 4][channel < 4 ? "leader" : "follower"];
nano.usart.onByteTransmit = (byte) => out.push(byte);
process.stdin.on("data", (data) => nano.usart.waiting.push(...data));
process.stdin.on("end", () => process.exit(0));
process.on("SIGUSR2", () => nano.externalReset());

let milliseconds = 0;
let due = performance.now();

function run() {
  nano.runUntil((milliseconds += 1) * PERIOD);
  moveArm(milliseconds / 1000, 0.001);
  if (out.length) process.stdout.write(Buffer.from(out.splice(0)));
  // Never faster than real time, not even to catch up: a lease must not run out before the host can renew it.
  const now = performance.now();
  due = Math.max(due + 1, now - 1);
  if (due > now + 1) setTimeout(run, due - now);
  else setImmediate(run);
}

run();
