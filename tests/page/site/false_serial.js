// A false navigator.serial: one port, whose other end is the test's. The board lives while the port is open, at most
// five times as fast as the clock but for a bootloader, and the page's waits are waits in the board's time.
(() => {
  const TURN_MS = 4, FAST = 115200, LONG_MS = 3000, BEFORE = 1e9;
  const wait = setTimeout, noWait = clearTimeout;
  const waits = new Map();
  let lived = 0, next = BEFORE;
  const fire = (now) => {
    for (const [id, { due, act }] of waits) {
      if (due <= now && waits.delete(id)) act();
    }
  };
  requestAnimationFrame = (act) => wait(act, 200, performance.now());
  setTimeout = (act, ms, ...given) => {
    if (!(ms < LONG_MS) || !port.readable) return wait(act, ms, ...given);
    waits.set(++next, { due: lived + ms, act });
    return next;
  };
  clearTimeout = (id) => id > BEFORE ? waits.delete(id) : noWait(id);

  const text = (data) => String.fromCharCode(...data);
  const bytes = (said) => Uint8Array.from(said, (one) => one.charCodeAt(0));
  class Port extends EventTarget {
    readable = null;
    writable = null;
    lowered = false;
    written = "";
    getInfo() { return { usbVendorId: 0x2341, usbProductId: 0x0042 }; }
    async open({ baudRate }) {
      if (this.readable) throw new DOMException("The port is already open.", "InvalidStateError");
      const refused = await boardPort("open", baudRate);
      if (refused) throw new DOMException(refused, "NetworkError");
      this.readable = new ReadableStream({ start: (ear) => { this.ear = ear; } });
      this.written = "";
      this.writable = new WritableStream({ write: (data) => { this.written += text(data); } });
      this.live(this.ear, baudRate <= FAST);
    }
    async live(ear, fast) {
      while (this.ear === ear) {
        const { written } = this;
        this.written = "";
        const told = await boardPort("live", written);
        if (this.ear !== ear) break;
        if (!told) return this.lose();
        const [lives, said] = told;
        lived = lives;
        if (said) ear.enqueue(bytes(said));
        fire(lived);
        await new Promise((go) => wait(go, fast ? 0 : TURN_MS)); // the page takes it in, and answers
      }
    }
    async setSignals({ dataTerminalReady: up }) {
      if (up && this.lowered) await boardPort("restart", "");
      this.lowered = !up;
    }
    async close() {
      this.end();
      await boardPort("close", this.written);
    }
    end() {
      this.ear = this.readable = this.writable = null;
      fire(Infinity);
    }
    lose() {
      const { ear } = this;
      this.end();
      ear.error(new DOMException("The device has been lost.", "NetworkError"));
    }
  }
  const port = new Port();
  const serial = new EventTarget();
  Object.assign(serial, {
    granted: [],
    getPorts: async () => serial.granted,
    requestPort: async () => {
      serial.granted = [port];
      return port;
    },
    plugIn: () => serial.dispatchEvent(Object.defineProperty(new Event("connect"), "target", { value: port })),
  });
  Object.defineProperty(navigator, "serial", { value: serial });
})();
