// SPDX-License-Identifier: GPL-3.0-or-later
// Intel HEX: one record a line, ":LLAAAATT<data>CC" in hexadecimal, where all bytes of a record add up to 0 (mod 256).
#include <fstream>

#include "error.h"
#include "image.h"

namespace board {

namespace {

enum RecordType : unsigned {
  data = 0,
  end_of_file = 1,
  segment_base = 2,
  segment_start = 3,
  linear_base = 4,
  linear_start = 5,
};

class HexReader {
 public:
  explicit HexReader(const std::string& path) : path_(path), file_(path) {
    if (!file_) throw BoardError(path + " cannot be opened; check that the file exists and may be read");
  }

  std::vector<Segment> read() {
    std::string line;
    while (!ended_ && std::getline(file_, line)) {
      ++line_number_;
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (!line.empty()) read_record(line);
    }
    if (!ended_) fail("the file stops before its end-of-file record");
    if (segments_.empty()) fail("the file holds no program bytes");
    return std::move(segments_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw BoardError(path_ + ", line " + std::to_string(line_number_) + ": " + what +
                     "; build or download the Intel HEX file again");
  }

  static int nibble(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return -1;
  }

  std::vector<uint8_t> decode(const std::string& line) const {
    if (line[0] != ':') fail("a record must begin with a colon");
    if (line.size() % 2 == 0 || line.size() < 11) fail("the record is cut short");
    std::vector<uint8_t> bytes;
    unsigned sum = 0;
    for (size_t i = 1; i < line.size(); i += 2) {
      const int high = nibble(line[i]), low = nibble(line[i + 1]);
      if (high < 0 || low < 0) fail("\"" + line.substr(i, 2) + "\" is not a hexadecimal byte");
      bytes.push_back(static_cast<uint8_t>(high << 4 | low));
      sum += bytes.back();
    }
    if (bytes.size() != bytes[0] + 5u)
      fail("the record announces " + std::to_string(bytes[0]) + " data bytes, but holds " +
           std::to_string(bytes.size() - 5));
    if (sum % 256) fail("the checksum is wrong");
    return bytes;
  }

  void read_record(const std::string& line) {
    const std::vector<uint8_t> record = decode(line);
    const uint32_t offset = static_cast<uint32_t>(record[1] << 8 | record[2]);
    const unsigned type = record[3];
    if ((type == segment_base || type == linear_base) && record[0] != 2)
      fail("a base address record must hold 2 bytes");
    const auto word = [&] { return static_cast<uint32_t>(record[4] << 8 | record[5]); };
    switch (type) {
      case data: append(base_ + offset, {record.begin() + 4, record.end() - 1}); break;
      case end_of_file: ended_ = true; break;
      case segment_base: base_ = word() << 4; break;
      case linear_base: base_ = word() << 16; break;
      case segment_start:
      case linear_start: break;  // where a PC would start; an AVR starts at its reset vector
      default: fail("record type " + std::to_string(type) + " is not one of Intel HEX");
    }
  }

  void append(uint32_t address, const std::vector<uint8_t>& bytes) {
    if (bytes.empty()) return;
    if (segments_.empty() || segments_.back().address + segments_.back().bytes.size() != address)
      segments_.push_back({address, {}});
    std::vector<uint8_t>& last = segments_.back().bytes;
    last.insert(last.end(), bytes.begin(), bytes.end());
  }

  std::string path_;
  std::ifstream file_;
  size_t line_number_ = 0;
  uint32_t base_ = 0;
  bool ended_ = false;
  std::vector<Segment> segments_;
};

}  // namespace

std::vector<Segment> read_intel_hex(const std::string& path) { return HexReader(path).read(); }

}  // namespace board
