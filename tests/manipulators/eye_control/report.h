#pragma once

#include <cstdarg>
#include <cstdio>

namespace eye::test {

/// One line of the acceptance table: the row's name, then what came out and what people do, in words and numbers.
__attribute__((format(printf, 2, 3))) inline void report(const char* row, const char* format, ...) {
  va_list arguments;
  va_start(arguments, format);
  std::printf("  %-4s ", row);
  std::vprintf(format, arguments);
  std::printf("\n");
  va_end(arguments);
}

}  // namespace eye::test
