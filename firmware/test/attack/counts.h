// What a program of the attacks has counted, as lines of a name and a number.
#pragma once
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>

namespace attack {

class Counts {
 public:
  std::uint64_t& operator[](const std::string& name) { return counts_[name]; }
  void print() const {
    for (const auto& count : counts_) {
      std::printf("%s %llu\n", count.first.c_str(), static_cast<unsigned long long>(count.second));
    }
  }

 private:
  std::map<std::string, std::uint64_t> counts_;
};

}  // namespace attack
