// Runs the module with which a page simulates a bench: `node bench.mjs MODULE` takes a JSON line for each call and
// answers with one. [name, ...numbers] calls an export; ["put", numbers] and ["fill", bytes as hex] fill its buffers;
// ["run", n] answers what the board said, ["read_eeprom"] its content, and ["look"] numbers.
import { readFileSync } from "node:fs";
import { createInterface } from "node:readline";

const refuse = () => { throw new Error("the module asked for a file"); };
const { instance } = await WebAssembly.instantiate(readFileSync(process.argv[2]), {
  wasi_snapshot_preview1: { fd_close: refuse, fd_seek: refuse, fd_write: refuse },
});
const { memory, ...calls } = instance.exports;
calls._initialize();
const numbers = () => new Float64Array(memory.buffer, calls.numbers(), 256);
const bytes = () => Buffer.from(memory.buffer, calls.bytes(), calls.bytes_size());

const special = {
  put: (values) => numbers().set(values),
  fill: (hex) => Buffer.from(hex, "hex").copy(bytes()),
  run: (slices) => bytes().toString("hex", 0, calls.run(slices)),
  read_eeprom: () => bytes().toString("hex", 0, calls.read_eeprom()),
  look() {
    calls.look();
    return Array.from(numbers().subarray(0, 12));
  },
};

for await (const line of createInterface({ input: process.stdin })) {
  const [name, ...given] = JSON.parse(line);
  const answer = (special[name] ?? calls[name])(...given);
  process.stdout.write(`${JSON.stringify(answer ?? null)}\n`);
}
