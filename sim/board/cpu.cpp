// Execution of AVR instructions. Program counter, time and deadline live in local variables; the Mcu's are brought up
// to date around everything that may look at them, such as the register hooks of the peripherals.
#include "cpu.h"

#include "alu.h"

#define ALWAYS_INLINE __attribute__((always_inline))

namespace board {

namespace {

constexpr size_t longest_step = 3;  // words from an instruction to the next without a jump

}  // namespace

Cpu::Cpu(Mcu& mcu)
    : mcu_(mcu),
      decoder_(mcu.flash.data(), mcu.chip.flash_bytes / 2, mcu.chip.wide_pc),
      mask_(mcu.chip.flash_bytes / 2 - 1),
      wide_pc_(mcu.chip.wide_pc),
      decoded_(mask_ + 1) {
  decoded_.resize(decoded_.size() + longest_step, {Code::wrapped});  // the flash begins anew behind its end
}

// An instruction also depends on up to two words after it.
void Cpu::flash_changed(uint32_t address, uint32_t count) {
  const uint32_t first = address / 2 + mask_ + 1 - 2, words = (count + 1) / 2 + 3;
  for (uint32_t word = first; word < first + words; ++word) decoded_[word & mask_] = {};
}

// What the instructions of one run work on. Nothing but run() knows its address, so a compiler keeps its members in
// registers from one instruction to the next.
struct Cpu::State {
  explicit State(Cpu& owner) : cpu(owner) {}

  ALWAYS_INLINE uint32_t pc() const { return static_cast<uint32_t>(op - decoded); }
  ALWAYS_INLINE const Instruction* at(uint32_t address) const { return decoded + (address & mask); }

  // ---- the Mcu ----

  ALWAYS_INLINE void hand_over() const {
    mcu.pc = pc() * 2;
    mcu.cycle = cycle;
  }
  ALWAYS_INLINE void take_back() {
    cycle = mcu.cycle;
    deadline = mcu.deadline();
  }
  ALWAYS_INLINE void refuse() {
    mcu.crash("an invalid instruction,", static_cast<uint32_t>(flash[2 * pc()] | flash[2 * pc() + 1] << 8));
    deadline = 0;
  }
  ALWAYS_INLINE void request(const Mcu::Action& action) {
    hand_over();
    action();
    take_back();
  }
  ALWAYS_INLINE void set_flag(bool value) {
    alu.store(flags);
    if (op->r == flag::I) mcu.set_interrupt_flag(value);
    else flags[op->r] = value;
    deadline = mcu.deadline();
    alu.load(flags);
  }
  ALWAYS_INLINE void allow_interrupts() {
    mcu.set_interrupt_flag(true);
    request(mcu.reti);
  }
  ALWAYS_INLINE void fall_asleep() {
    if (!(data[reg::SMCR] & SE) || (mcu.pending && flags[flag::I])) return;
    mcu.state = Mcu::State::asleep;
    deadline = 0;
  }

  // ---- operands and memory ----

  ALWAYS_INLINE uint8_t& d() const { return data[op->d]; }
  ALWAYS_INLINE unsigned r() const { return data[op->r]; }
  ALWAYS_INLINE unsigned k8() const { return op->k & 0xFFu; }
  ALWAYS_INLINE int signed_d() const { return static_cast<int8_t>(data[op->d]); }
  ALWAYS_INLINE int signed_r() const { return static_cast<int8_t>(data[op->r]); }

  ALWAYS_INLINE bool in_ram(uint32_t address) const { return __builtin_expect(address - first_ram < ram_size, true); }
  ALWAYS_INLINE uint8_t read_io(uint32_t address) {
    if (address - first_register < register_count && !registers[address - first_register].read && address != reg::SREG)
      return data[address];
    if (address == reg::SREG) alu.store(flags);
    hand_over();
    const uint8_t value = mcu.read(address);
    take_back();
    return value;
  }
  ALWAYS_INLINE void write_io(uint32_t address, unsigned value) {
    if (address - first_register < register_count && !registers[address - first_register].write &&
        address != reg::SREG) {
      data[address] = static_cast<uint8_t>(value);
      return;
    }
    hand_over();
    mcu.write(address, static_cast<uint8_t>(value));
    take_back();
    if (address == reg::SREG) alu.load(flags);
  }
  ALWAYS_INLINE uint8_t read(uint32_t address) { return in_ram(address) ? data[address] : read_io(address); }
  ALWAYS_INLINE void write(uint32_t address, uint8_t value) {
    if (in_ram(address)) data[address] = value;
    else write_io(address, value);
  }
  ALWAYS_INLINE uint32_t word(unsigned low) const { return data[low] | static_cast<uint32_t>(data[low + 1]) << 8; }
  ALWAYS_INLINE void set_word(unsigned low, uint32_t value) {
    data[low] = static_cast<uint8_t>(value);
    data[low + 1] = static_cast<uint8_t>(value >> 8);
  }
  ALWAYS_INLINE uint32_t extended_z(uint16_t high) const {
    return word(reg::ZL) | static_cast<uint32_t>(data[high]) << 16;
  }
  ALWAYS_INLINE void load_and_move(uint32_t pointer, uint32_t moved) {
    const uint8_t value = read(pointer & 0xFFFFu);
    set_word(op->r, moved);
    d() = value;
  }
  ALWAYS_INLINE void store_and_move(uint32_t pointer, uint32_t moved) {
    write(pointer & 0xFFFFu, d());
    set_word(op->r, moved);
  }
  ALWAYS_INLINE uint8_t load_flash_and_move(uint32_t z) {
    d() = flash[z & flash_end];
    set_word(reg::ZL, z + 1);
    return static_cast<uint8_t>((z + 1) >> 16);
  }

  // ---- stack and flow ----

  ALWAYS_INLINE void push(uint32_t value) {
    const uint32_t stack = word(reg::SPL);
    write(stack, static_cast<uint8_t>(value));
    set_word(reg::SPL, stack - 1);
  }
  ALWAYS_INLINE uint8_t pop() {
    const uint32_t stack = (word(reg::SPL) + 1) & 0xFFFFu;
    const uint8_t value = read(stack);
    set_word(reg::SPL, stack);
    return value;
  }
  ALWAYS_INLINE void call(uint32_t target, uint32_t back) {
    push(back);
    push(back >> 8);
    if (wide_pc) push(back >> 16);
    next = at(target);
  }
  ALWAYS_INLINE void go_back() {
    uint32_t address = wide_pc ? static_cast<uint32_t>(pop()) << 16 : 0u;
    address |= static_cast<uint32_t>(pop()) << 8;
    next = at(address | pop());
  }
  ALWAYS_INLINE void branch(bool condition) {
    if (!condition) return;
    next = at(op->k);
    ++cycle;
  }
  ALWAYS_INLINE void skip(bool condition, uint32_t words) {
    if (!condition) return;
    next += words;
    cycle += words;
  }

  Cpu& cpu;
  Mcu& mcu = cpu.mcu_;
  uint8_t* const data = mcu.data.data();
  uint8_t* const flags = mcu.flags.data();
  const uint8_t* const flash = mcu.flash.data();
  const Mcu::Register* const registers = mcu.registers.data();
  Instruction* const decoded = cpu.decoded_.data();
  const uint32_t mask = cpu.mask_, flash_end = mcu.chip.flash_bytes - 1, first_ram = mcu.chip.first_ram,
                 ram_size = mcu.chip.ram_end + 1u - first_ram, register_count = first_ram - first_register;
  const bool wide_pc = cpu.wide_pc_;
  Alu alu{flags};
  const Instruction* op = decoded + mcu.pc / 2;
  const Instruction* next = op;
  uint64_t cycle = mcu.cycle;
  uint64_t deadline = mcu.deadline();
};

void Cpu::run() {
  State s(*this);

  // A jump of its own behind each instruction: the processor foresees it by the instruction before.
#define LABEL(code) (&&code),
  static const void* const labels[] = {BOARD_CODES(LABEL)};
#undef LABEL
#define DISPATCH     \
  s.next = s.op + 1; \
  goto* labels[static_cast<size_t>(s.op->code)]
#define ON(code, ...)                  \
  code:                                \
  __VA_ARGS__;                         \
  s.cycle += s.op->cycles;             \
  s.op = s.next;                       \
  if (s.cycle >= s.deadline) goto due; \
  DISPATCH

  DISPATCH;

undecoded:
  s.decoded[s.pc()] = decoder_.decode(s.pc());
  DISPATCH;
wrapped:
  s.op -= mask_ + 1;
  DISPATCH;
  ON(invalid, s.refuse(), s.next = s.op);
  ON(nop, {});

  ON(add, s.d() = s.alu.add(s.d(), s.r(), 0));
  ON(adc, s.d() = s.alu.add(s.d(), s.r(), s.alu.carry()));
  ON(sub, s.d() = s.alu.subtract(s.d(), s.r(), 0));
  ON(sbc, s.d() = s.alu.subtract_with_borrow(s.d(), s.r()));
  ON(logic_and, s.d() = s.alu.logic(s.d() & s.r()));
  ON(logic_or, s.d() = s.alu.logic(s.d() | s.r()));
  ON(logic_xor, s.d() = s.alu.logic(s.d() ^ s.r()));
  ON(mov, s.d() = s.data[s.op->r]);
  ON(cp, s.alu.subtract(s.d(), s.r(), 0));
  ON(cpc, s.alu.subtract_with_borrow(s.d(), s.r()));
  ON(subi, s.d() = s.alu.subtract(s.d(), s.k8(), 0));
  ON(sbci, s.d() = s.alu.subtract_with_borrow(s.d(), s.k8()));
  ON(andi, s.d() = s.alu.logic(s.d() & s.k8()));
  ON(ori, s.d() = s.alu.logic(s.d() | s.k8()));
  ON(ldi, s.d() = static_cast<uint8_t>(s.op->k));
  ON(cpi, s.alu.subtract(s.d(), s.k8(), 0));

  ON(com, s.d() = s.alu.complement(s.d()));
  ON(neg, s.d() = s.alu.subtract(0, s.d(), 0));
  ON(swap, s.d() = static_cast<uint8_t>(s.d() >> 4 | s.d() << 4));
  ON(inc, s.d() = s.alu.increment(s.d()));
  ON(dec, s.d() = s.alu.decrement(s.d()));
  ON(asr, s.d() = s.alu.shift_right(s.d(), s.d() >> 7));
  ON(lsr, s.d() = s.alu.shift_right(s.d(), 0));
  ON(ror, s.d() = s.alu.shift_right(s.d(), s.alu.carry()));
  ON(movw, s.set_word(s.op->d, s.word(s.op->r)));
  ON(adiw, s.set_word(s.op->d, s.alu.add_word(s.word(s.op->d), s.k8())));
  ON(sbiw, s.set_word(s.op->d, s.alu.subtract_word(s.word(s.op->d), s.k8())));
  ON(mul, s.set_word(0, s.alu.product(static_cast<int>(s.d() * s.r()), false)));
  ON(muls, s.set_word(0, s.alu.product(s.signed_d() * s.signed_r(), false)));
  ON(mulsu, s.set_word(0, s.alu.product(s.signed_d() * static_cast<int>(s.r()), false)));
  ON(fmul, s.set_word(0, s.alu.product(static_cast<int>(s.d() * s.r()), true)));
  ON(fmuls, s.set_word(0, s.alu.product(s.signed_d() * s.signed_r(), true)));
  ON(fmulsu, s.set_word(0, s.alu.product(s.signed_d() * static_cast<int>(s.r()), true)));

  ON(bset, s.set_flag(true));
  ON(bclr, s.set_flag(false));
  ON(bst, s.flags[flag::T] = static_cast<uint8_t>(s.d() >> s.op->r & 1));
  ON(bld,
     s.d() = static_cast<uint8_t>((s.d() & ~(1u << s.op->r)) | static_cast<unsigned>(s.flags[flag::T]) << s.op->r));
  ON(sbi, s.write_io(s.op->k, s.read_io(s.op->k) | s.op->r));
  ON(cbi, s.write_io(s.op->k, s.read_io(s.op->k) & ~static_cast<unsigned>(s.op->r)));

  ON(load, s.d() = s.read((s.word(s.op->r) + s.op->k) & 0xFFFFu));
  ON(load_increment, s.load_and_move(s.word(s.op->r), s.word(s.op->r) + 1));
  ON(load_decrement, s.load_and_move(s.word(s.op->r) - 1, s.word(s.op->r) - 1));
  ON(load_direct, s.d() = s.read(s.op->k), ++s.next);
  ON(in, s.d() = s.read_io(s.op->k));
  ON(store, s.write((s.word(s.op->r) + s.op->k) & 0xFFFFu, s.d()));
  ON(store_increment, s.store_and_move(s.word(s.op->r), s.word(s.op->r) + 1));
  ON(store_decrement, s.store_and_move(s.word(s.op->r) - 1, s.word(s.op->r) - 1));
  ON(store_direct, s.write(s.op->k, s.d()), ++s.next);
  ON(out, s.write_io(s.op->k, s.d()));
  ON(push, s.push(s.d()));
  ON(pop, s.d() = s.pop());

  ON(lpm, s.d() = s.flash[s.word(reg::ZL) & s.flash_end]);
  ON(elpm, s.d() = s.flash[s.extended_z(reg::RAMPZ) & s.flash_end]);
  ON(lpm_increment, s.load_flash_and_move(s.word(reg::ZL)));
  ON(elpm_increment, s.data[reg::RAMPZ] = s.load_flash_and_move(s.extended_z(reg::RAMPZ)));
  ON(spm, s.request(s.mcu.spm));

  ON(jump, s.next = s.at(s.op->k));
  ON(call, s.call(s.op->k, s.pc() + s.op->d));
  ON(ijmp, s.next = s.at(s.word(reg::ZL)));
  ON(eijmp, s.next = s.at(s.extended_z(reg::EIND)));
  ON(icall, s.call(s.word(reg::ZL), s.pc() + 1));
  ON(eicall, s.call(s.extended_z(reg::EIND), s.pc() + 1));
  ON(reti, s.allow_interrupts(), s.go_back());
  ON(ret, s.go_back());
  ON(branch_by_carry, s.branch(s.alu.carry() == s.op->d));
  ON(branch_by_zero, s.branch(s.alu.zero() == s.op->d));
  ON(branch_by_negative, s.branch(s.alu.negative() == s.op->d));
  ON(branch_by_overflow, s.branch(s.alu.overflow() == s.op->d));
  ON(branch_by_sign, s.branch(s.alu.sign() == s.op->d));
  ON(branch_by_half_carry, s.branch(s.alu.half_carry() == s.op->d));
  ON(branch_by_transfer, s.branch(s.flags[flag::T] == s.op->d));
  ON(branch_by_interrupts, s.branch(s.flags[flag::I] == s.op->d));
  ON(cpse, s.skip(s.d() == s.r(), s.op->k));
  ON(sbrc, s.skip(!(s.d() >> s.op->r & 1), s.op->k));
  ON(sbrs, s.skip(s.d() >> s.op->r & 1, s.op->k));
  ON(sbic, s.skip(!(s.read_io(s.op->k) & s.op->r), s.op->d));
  ON(sbis, s.skip(s.read_io(s.op->k) & s.op->r, s.op->d));
  ON(sleep, s.fall_asleep());
  ON(wdr, s.request(s.mcu.wdr));
#undef ON
#undef DISPATCH

due:
  s.alu.store(s.flags);
  mcu_.cycle = s.cycle;
  mcu_.pc = (s.pc() & mask_) * 2;
}

}  // namespace board
