// A hang with interrupts off, for the watchdog: `node hang.js FIRMWARE.hex`, one JSON object on stdout.
"use strict";

const { Nano, HZ } = require("./nano.js");

const SELF_JUMP = 0xcfff; // rjmp .-2
const SREG = 0x5f, PORTB = 0x25, DRIVERS = 1 << 4;

const nano = new Nano(process.argv[2]);
const { cpu } = nano;
const sent = [];
nano.usart.onByteTransmit = (byte) => sent.push(byte);
nano.adc.voltage = () => 2.5;
nano.runUntil(HZ / 20);
sent.length = 0;

const [place, word] = [cpu.pc, cpu.progMem[cpu.pc]];
cpu.data[PORTB] |= DRIVERS; // as if the motors were on
cpu.progMem[place] = SELF_JUMP;
cpu.data[SREG] &= 0x7f;
const begun = cpu.cycles;
while (!nano.resets && cpu.cycles < begun + HZ) nano.runUntil(cpu.cycles + 1);
const cycles = cpu.cycles - begun;
cpu.progMem[place] = word;
nano.runUntil(cpu.cycles + HZ / 1000);
const drivers = Boolean(cpu.data[PORTB] & DRIVERS);
nano.runUntil(cpu.cycles + HZ / 20);
process.stdout.write(JSON.stringify({ resets: nano.resets, cycles, drivers, sent: Buffer.from(sent).toString("hex") }));
