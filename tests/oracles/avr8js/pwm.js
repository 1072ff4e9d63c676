// The PWM pins by avr8js's own timers: `node pwm.js FIRMWARE.hex A B C D` with four compare values; mean levels and
// periods (cycles) of the four pins as JSON on stdout.
"use strict";

const { Nano, HZ } = require("./nano.js");

const [hexFile, ...values] = process.argv.slice(2);
const nano = new Nano(hexFile, true);
const { cpu, ports } = nano;
nano.adc.voltage = () => 2.5;
nano.runUntil(HZ / 50); // the firmware has set its timers up

const [a, b, c, d] = values.map(Number);
const writes = [[0x89, a >> 8], [0x88, a & 255], [0x8b, b >> 8], [0x8a, b & 255], [0xb3, c], [0xb4, d]];
for (const [register, value] of writes) cpu.writeData(register, value);
nano.runUntil(cpu.cycles + HZ / 1000);

// D9, D10, D11, D3
const places = [["B", 1], ["B", 2], ["B", 3], ["D", 3]];
const pins = places.map(([port, bit]) => ({ port, mask: 1 << bit, high: 0, rises: [], since: 0 }));
for (const pin of pins) {
  ports[pin.port].addListener((now, before) => {
    if (!((now ^ before) & pin.mask)) return;
    if (now & pin.mask) pin.rises.push((pin.since = cpu.cycles));
    else if (pin.rises.length) pin.high += cpu.cycles - pin.since;
  });
}
nano.runUntil(cpu.cycles + HZ / 100);
const result = pins.map(({ high, rises }) => {
  const turns = rises.length - 1;
  const span = rises[turns] - rises[0];
  return { mean: high / (span + span / turns), period: span / turns };
});
process.stdout.write(JSON.stringify(result));
