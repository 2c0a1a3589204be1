#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <string_view>

#include "dialog_manager/array_frames.h"
#include "dialog_manager/array_memory.h"
#include "objdb/database.h"
#include "objdb/text.h"

namespace manager {

/// The memory that one life of a program was given to fill, and what it filled there and announced.
class GrantedArrays {
 public:
  explicit GrantedArrays(const objdb::Database& world) : world_(world) {}

  /// Another life of the program begins, which was given nothing.
  void begin_life();

  /// It said a long array as text: it could say that shorter.
  void note_long(const objdb::Word& target);
  /// Gives memory for what was noted. `say`: to the program; `event`: no memory, the array stays text.
  void grant(const std::function<void(const std::string&)>& say, const std::function<void(const std::string&)>& event);

  /// "put PATH.FIELD slot=K seq=N": the numbers are taken as soon as they are announced. `owner`: who says it; `event`:
  /// no (more) memory for others to read them in. Errors: syntax, owner (no such memory), range (another slot or
  /// sequence, numbers that are none).
  objdb::Status fill(objdb::Words words, const std::string& owner,
                     const std::function<void(const std::string&)>& event);
  /// What was filled as this sequence of a field; once. Error unknown.
  objdb::Result<objdb::Numbers> take(std::string_view target, std::uint64_t sequence);
  /// What was filled and not taken is not meant any more.
  void drop_filled() { filled_.clear(); }

 private:
  struct Granted {
    std::shared_ptr<ArrayMemory> memory;
    std::unique_ptr<ArrayFrames> frames;  // what it announced
    std::size_t wanted = 0;
    std::uint64_t sequence = 0;
  };
  struct Filled {
    std::string target;  // PATH.FIELD
    std::uint64_t sequence = 0;
    objdb::Numbers numbers;
  };
  std::size_t long_size(std::string_view name) const;

  const objdb::Database& world_;
  std::map<std::string, Granted, std::less<>> granted_;  // by PATH.FIELD
  std::set<std::string, std::less<>> long_sets_;         // said as text, by PATH.FIELD
  std::deque<Filled> filled_;
};

}  // namespace manager
