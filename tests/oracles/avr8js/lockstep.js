// Runs a scenario tick by tick: `node lockstep.js FIRMWARE.hex SCENARIO.json VOLTS.f32 TICKS`, a JSON object on stdout.
// The scenario has the bytes to send, in hex, by tick. VOLTS has a voltage for each tick, conversion and channel.
"use strict";

const fs = require("node:fs");
const { Nano } = require("./nano.js");

const sendAt = (tick) => 4500 + ((tick * 61) % 5000); // cycles after a tick, another phase each time
// Conversion n samples near FIRST + EACH * n cycles after a tick. Voltages change half-way between two conversions; until
// the first of them they are those of the tick before.
const FIRST = 2256, EACH = 416, CONVERSIONS = 32, CHANNELS = 8;

const [hexFile, scenarioFile, voltsFile, count] = process.argv.slice(2);
const sends = JSON.parse(fs.readFileSync(scenarioFile, "utf8"));
const bytes = fs.readFileSync(voltsFile);
const volts = new Float32Array(bytes.buffer, bytes.byteOffset, bytes.byteLength / 4);

const nano = new Nano(hexFile);
const { cpu } = nano;
const sent = []; // by the board
const outputs = []; // at the end of each tick
let tick = -1;
let start = 0;

nano.usart.onByteTransmit = (byte) => sent.push(byte);
nano.adc.voltage = (channel) => {
  const conversion = Math.floor((cpu.cycles - start - FIRST + EACH / 2) / EACH);
  const place = tick * CONVERSIONS + Math.min(Math.max(conversion, -1), CONVERSIONS - 1);
  return tick < 0 || place < 0 ? 2.5 : volts[place * CHANNELS + channel];
};
nano.onTick = () => {
  if (tick >= 0) outputs.push(nano.outputs());
  tick += 1;
  start = cpu.cycles;
  const message = sends[tick];
  if (message) cpu.addClockEvent(() => nano.usart.waiting.push(...Buffer.from(message, "hex")), sendAt(tick));
};

while (outputs.length < Number(count)) nano.runUntil(cpu.cycles + 4000);
const hex = (data) => Buffer.from(data).toString("hex");
process.stdout.write(JSON.stringify({ outputs, sent: hex(sent), eeprom: hex(nano.eepromBytes.memory) }));
