// An Arduino Nano in avr8js: CPU, the peripherals that the firmware uses, and what avr8js lacks of them.
"use strict";

const fs = require("node:fs");
const avr = require("avr8js");

const HZ = 16_000_000;
const FLASH_WORDS = 0x4000;
const RAM_BYTES = 2048;
const TICK_VECTOR = 14 * 2; // TIMER0_COMPA, a word address
const ADEN = 0x80, ADSC = 0x40, ADATE = 0x20, ADIF = 0x10, ADTS = 0x07;
const RXEN = 0x10, RXC = 0x80;
const MCUSR = 0x54, PORF = 0x01;

/** Adds free-running conversion, the end of a conversion by ADEN = 0, and clearing ADIF by writing one to it. */
class FreeRunningAdc extends avr.AVRADC {
  constructor(cpu) {
    super(cpu, avr.adcConfig);
    const { ADCSRA } = this.config;
    const start = cpu.writeHooks[ADCSRA];
    this.pending = null;
    this.voltage = () => 0; // of a channel, at the start of its conversion
    cpu.writeHooks[ADCSRA] = (value, old) => {
      if (value & ADIF) cpu.clearInterrupt(this.ADC);
      const flag = value & ADIF ? 0 : old & ADIF;
      if (!(value & ADEN) && this.converting) {
        cpu.clearClockEvent(this.pending);
        this.converting = false;
      }
      const going = this.converting || (value & ADEN && value & ADSC) ? ADSC : 0;
      start((value & ~(ADIF | ADSC)) | (this.converting ? 0 : value & ADSC) | flag, old);
      cpu.data[ADCSRA] = (value & ~(ADIF | ADSC)) | flag | going;
      return true;
    };
    this.onADCRead = (input) => this.convert(input, cpu.cycles);
  }

  /** A conversion that starts at this cycle, which may be a few before the end of the instruction under way. */
  convert(input, start) {
    const volts = input.voltage ?? this.voltage(input.channel); // ground has its own
    const result = Math.floor((volts / this.referenceVoltage) * 1024);
    const end = start + this.sampleCycles;
    this.pending = this.cpu.addClockEvent(() => this.complete(result, end), end - this.cpu.cycles);
  }

  complete(result, end) {
    this.completeADCRead(Math.min(Math.max(result, 0), 1023));
    const { ADCSRA, ADCSRB, ADMUX } = this.config;
    const { data } = this.cpu;
    if (!(data[ADCSRA] & ADATE) || data[ADCSRB] & ADTS) return;
    data[ADCSRA] |= ADSC;
    this.converting = true;
    this.convert(this.config.muxChannels[data[ADMUX] & this.config.muxInputMask], end);
  }
}

/** avr8js drops a received byte when UCSR0B is written with the receiver on; a chip drops it when it is turned off. */
class Usart extends avr.AVRUSART {
  constructor(cpu) {
    super(cpu, avr.usart0Config, HZ);
    const { UCSRA, UCSRB } = this.config;
    const write = cpu.writeHooks[UCSRB];
    this.waiting = []; // bytes on their way to the board
    cpu.writeHooks[UCSRB] = (value, old) => {
      const received = cpu.data[UCSRA] & RXC;
      write(value, old);
      if (received && value & RXEN) cpu.setInterruptFlag(this.RXC);
      return true;
    };
  }

  /** Puts the next byte on the line when it is free and the last one has been read. */
  feed() {
    if (this.waiting.length && !this.rxBusy && !(this.cpu.data[this.config.UCSRA] & RXC)) {
      if (this.writeByte(this.waiting[0])) this.waiting.shift();
    }
  }
}

class Nano {
  /** An Intel HEX file; `pwm` simulates the PWM timers too, which takes most of the time. */
  constructor(hexFile, pwm = false) {
    const words = new Uint16Array(FLASH_WORDS).fill(0xffff);
    loadHex(fs.readFileSync(hexFile, "utf8"), new Uint8Array(words.buffer));
    this.cpu = new avr.CPU(words, RAM_BYTES);
    const { cpu } = this;
    this.ports = Object.fromEntries(
      ["B", "C", "D"].map((letter) => [letter, new avr.AVRIOPort(cpu, avr[`port${letter}Config`])]),
    );
    // Emergency stop and clutch: their pull-ups hold them high, and avr8js has none.
    this.ports.D.setPin(5, true);
    this.ports.D.setPin(6, true);
    this.timers = [avr.timer0Config, ...(pwm ? [avr.timer1Config, avr.timer2Config] : [])].map(
      (config) => new avr.AVRTimer(cpu, config),
    );
    this.adc = new FreeRunningAdc(cpu);
    this.usart = new Usart(cpu);
    this.eepromBytes = new avr.EEPROMMemoryBackend(1024);
    this.eeprom = new avr.AVREEPROM(cpu, this.eepromBytes);
    this.onTick = () => {};
    cpu.data[MCUSR] = PORF; // a power-on, which avr8js does not record
  }

  /** Runs to the first instruction boundary at or after this cycle; calls onTick() at each tick's interrupt. */
  runUntil(cycle) {
    const { cpu, usart } = this;
    while (cpu.cycles < cycle) {
      avr.avrInstruction(cpu);
      const { pc } = cpu;
      cpu.tick();
      if (cpu.pc === TICK_VECTOR && pc !== TICK_VECTOR) this.onTick();
      usart.feed();
    }
  }

  /** The compare values, and the ports with directions, drivers and LED: OCR1A, OCR1B, OCR2A, OCR2B, PORTB, PORTD. */
  outputs() {
    const { data } = this.cpu;
    const word = (low) => data[low] | (data[low + 1] << 8);
    return [word(0x88), word(0x8a), data[0xb3], data[0xb4], data[0x25], data[0x2b]];
  }
}

function loadHex(text, flash) {
  for (const line of text.split("\n")) {
    if (line[0] !== ":" || line.slice(7, 9) !== "00") continue;
    const bytes = Buffer.from(line.slice(1).trim(), "hex");
    flash.set(bytes.subarray(4, 4 + bytes[0]), bytes.readUInt16BE(1));
  }
}

module.exports = { Nano, HZ, loadHex };
