// Runs programs to their SLEEP: `node program.js ATMEGA2560|ATMEGA328P LIMIT PROGRAM.hex...`. On stdout a line of JSON for each:
// the cycles until then, the word address, and the data space below the stack's end in hexadecimal; LIMIT cycles at most.
"use strict";

const fs = require("node:fs");
const avr = require("avr8js");
const { loadHex } = require("./nano.js");

const CHIPS = { atmega2560: { flash: 0x40000, end: 0x2200 }, atmega328p: { flash: 0x8000, end: 0x900 } };
const SLEEP = 0x9588;

const [chip, limit, ...programs] = process.argv.slice(2);
const { flash, end } = CHIPS[chip];
for (const program of programs) {
  const words = new Uint16Array(flash / 2).fill(0xffff);
  loadHex(fs.readFileSync(program, "utf8"), new Uint8Array(words.buffer));
  const cpu = new avr.CPU(words, end - 0x100);
  while (cpu.cycles < Number(limit) && words[cpu.pc] !== SLEEP) avr.avrInstruction(cpu);
  const data = Buffer.from(cpu.data.subarray(0, end)).toString("hex");
  process.stdout.write(JSON.stringify({ cycles: cpu.cycles, pc: cpu.pc, data }) + "\n");
}
