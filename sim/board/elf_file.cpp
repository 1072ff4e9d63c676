// SPDX-License-Identifier: GPL-3.0-or-later
// ELF programs of avr-gcc: the PT_LOAD segments by physical address. simavr's own loader takes only sections it knows
// by name and would leave out everything else a linker script places.
#include <elf.h>

#include <cstring>
#include <fstream>
#include <iterator>

#include "error.h"
#include "image.h"

namespace board {

namespace {

class ElfReader {
 public:
  explicit ElfReader(const std::string& path) : path_(path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw BoardError(path + " cannot be opened; check that the file exists and may be read");
    bytes_.assign(std::istreambuf_iterator<char>(file), {});
  }

  ElfImage read() const {
    const auto header = take<Elf32_Ehdr>(0, "the ELF header");
    if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0) fail("it does not begin like an ELF file");
    if (header.e_ident[EI_CLASS] != ELFCLASS32 || header.e_machine != EM_AVR) fail("it is not a program for an AVR");
    if (header.e_type != ET_EXEC) fail("it is not linked");
    ElfImage image;
    image.architecture = header.e_flags & 0x7Fu;
    for (unsigned i = 0; i < header.e_phnum; ++i) {
      const size_t offset = size_t{header.e_phoff} + size_t{i} * header.e_phentsize;
      const auto program = take<Elf32_Phdr>(offset, "a program header");
      if (program.p_type != PT_LOAD || program.p_filesz == 0) continue;
      require(program.p_offset, program.p_filesz, "a segment");
      const auto begin = bytes_.begin() + program.p_offset;
      image.segments.push_back({program.p_paddr, {begin, begin + program.p_filesz}});
    }
    if (image.segments.empty()) fail("it holds nothing to load");
    return image;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw BoardError(path_ + ": " + what + "; give the .elf that avr-gcc or PlatformIO linked");
  }

  void require(size_t offset, size_t size, const char* what) const {
    if (offset > bytes_.size() || size > bytes_.size() - offset) fail(std::string("the file ends inside ") + what);
  }

  template <class T>
  T take(size_t offset, const char* what) const {
    require(offset, sizeof(T), what);
    T value;
    std::memcpy(&value, bytes_.data() + offset, sizeof value);
    return value;
  }

  std::string path_;
  std::vector<uint8_t> bytes_;
};

}  // namespace

ElfImage read_elf(const std::string& path) { return ElfReader(path).read(); }

}  // namespace board
