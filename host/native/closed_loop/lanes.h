// Sixteen lanes in the form that suits the instruction set of this file's options.
#pragma once

#ifdef __AVX512F__
#include "lanes_avx512.h"
#else
#include "lanes_portable.h"
#endif
