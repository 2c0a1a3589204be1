#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "objdb/numbers.h"
#include "objdb/result.h"
#include "objdb/text.h"

namespace manager {

/// The long arrays of a journal, in a file beside it (docs/journal.md): numbers as they stand in memory, one array
/// behind the other. The journal says where each one stands, and a check over it.
class ArrayFile {
 public:
  /// The file that belongs to this journal.
  static std::string path_of(const std::string& journal) { return journal + ".arrays"; }
  /// Goes on at its end. Errors: io.
  static objdb::Result<std::unique_ptr<ArrayFile>> open(const std::string& path);
  ~ArrayFile();
  ArrayFile(const ArrayFile&) = delete;
  ArrayFile& operator=(const ArrayFile&) = delete;

  /// Hands the numbers to the system: "count=N at=BYTE check=HEX". Error io: nothing was added.
  objdb::Result<std::string> add(const objdb::Numbers& numbers);
  /// Waits for the disk. False: it breaks.
  bool sync();

  /// What such words tell of. Errors: syntax, io (not there, another check).
  static objdb::Result<std::vector<double>> read(const std::string& path, objdb::Words words);

 private:
  ArrayFile() = default;

  std::string path_;
  int file_ = -1;
  std::uint64_t size_ = 0;
  bool unsynced_ = false;
};

}  // namespace manager
