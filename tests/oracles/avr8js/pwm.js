// The PWM pins by avr8js's own timers, while the firmware drives four motors: `node pwm.js FIRMWARE.hex FRAME` with the
// bytes of an enable request in hexadecimal. JSON on stdout: each pin's compare value, mean level and period (cycles),
// and whether the pins moved at all before the board was enabled.
"use strict";

const { Nano, HZ } = require("./nano.js");

const [hexFile, frame] = process.argv.slice(2);
const nano = new Nano(hexFile, true);
const { cpu, ports } = nano;
// Leaders are off their followers by up to 0.3 rad: voltages that stay as they are, too small for a fault.
const leaders = [2.52, 2.54, 2.44, 2.57];
nano.adc.voltage = (channel) => (channel < 4 ? leaders[channel] : 2.5);

// D9, D10, D11, D3; the low byte of each compare register, and its high byte
const places = [["B", 1, 0x88, 0x89], ["B", 2, 0x8a, 0x8b], ["B", 3, 0xb3], ["D", 3, 0xb4]];
const pins = places.map(([port, bit]) => ({ port, mask: 1 << bit, high: 0, rises: [], since: 0 }));
for (const pin of pins) {
  ports[pin.port].addListener((now, before) => {
    if (!((now ^ before) & pin.mask)) return;
    if (now & pin.mask) pin.rises.push((pin.since = cpu.cycles));
    else if (pin.rises.length) pin.high += cpu.cycles - pin.since;
  });
}
nano.runUntil(HZ / 20);
const early = pins.some((pin) => pin.rises.length > 0);
nano.usart.waiting.push(...Buffer.from(frame, "hex"));
nano.runUntil(cpu.cycles + 1.2 * HZ); // past the soft start
for (const pin of pins) Object.assign(pin, { high: 0, rises: [] });
nano.runUntil(cpu.cycles + HZ / 100);
const result = pins.map(({ high, rises }, place) => {
  const [, , low, upper] = places[place];
  const turns = rises.length - 1;
  const span = rises[turns] - rises[0];
  const compare = cpu.data[low] | (upper ? cpu.data[upper] << 8 : 0);
  return { compare, mean: high / (span + span / turns), period: span / turns };
});
process.stdout.write(JSON.stringify({ early, pins: result }));
