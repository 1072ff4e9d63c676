// How many times faster than real time the page's bench runs: the motors on, a hand that swings, a sample each tick.
// Given are the module, the numbers of its arm, and what asks for samples and for motors; no backticks, for this goes into a template.
async (code, arm, frames, ticks) => {
  const none = () => { throw new Error("the bench asked for a file"); };
  const files = { fd_close: none, fd_seek: none, fd_write: none };
  const { instance } = await WebAssembly.instantiate(code, { wasi_snapshot_preview1: files });
  const { memory, ...bench } = instance.exports;
  bench._initialize();
  const numbers = () => new Float64Array(memory.buffer, bench.numbers(), 256);
  numbers().set(arm);
  bench.start(1);
  bench.power(1);
  for (let tick = 0; tick < 100; tick++) bench.run(4);
  new Uint8Array(memory.buffer, bench.bytes(), frames.length).set(frames);
  bench.send(frames.length);
  const begun = performance.now();
  let said = 0;
  for (let tick = 0; tick < ticks; tick++) {
    numbers().set([0.5 * Math.sin(tick / 600), 0.4 * Math.sin(tick / 700), 0.3, 0.2 * Math.sin(tick / 500)]);
    bench.lead();
    said += bench.run(4);
  }
  if (said < 30 * ticks) throw new Error("the board was silent");
  return ticks / (performance.now() - begun);
}
