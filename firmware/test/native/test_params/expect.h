// A REQUIRE for loops of many thousand turns: silent while it holds, where doctest's would report each success.
#pragma once

#include <doctest/doctest.h>

#define EXPECT(condition)                          \
  do {                                             \
    if (!(condition)) FAIL("not so: " #condition); \
  } while (false)
