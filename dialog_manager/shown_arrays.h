#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "dialog_manager/tale.h"
#include "objdb/database.h"

namespace manager {

/// The arrays that one life of a program has been told to read where they stand. Each stays as it is until the program
/// has read the line that tells of the next one.
class ShownArrays {
 public:
  explicit ShownArrays(const objdb::Database& world) : world_(world) {}

  /// Tells of an array: `put`, before it `array` when it stands in memory that the program has not opened; as text to a
  /// program that does not share memory, and when it stands in none.
  void say(std::string& out, const Frame& frame, bool shares);
  /// The program has read all lines that it was told.
  void all_read();
  /// That life is over, and the next one has opened nothing.
  void end_life();

 private:
  struct Shown {
    std::uint64_t memory = 0;  // serial
    objdb::Numbers numbers;
  };
  const objdb::Database& world_;
  std::map<std::pair<objdb::ObjectId, const objdb::Field*>, Shown> shown_;  // looked up, never gone through in order
  std::vector<objdb::Numbers> before_;                                      // perhaps still read
};

}  // namespace manager
