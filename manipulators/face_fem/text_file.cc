#include "manipulators/face_fem/text_file.h"

#include <cstdio>
#include <cstring>

namespace face {

Status TextFile::write(const std::string& path) const {
  // a neighbour is written and then renamed, so that nobody sees half a file; devices and pipes are written straight
  const bool device = path.rfind("/dev/", 0) == 0;
  const std::string draft = device ? path : path + ".part";
  std::FILE* file = std::fopen(draft.c_str(), "wb");
  if (file == nullptr) return Error{Fault::io, path + ": cannot be opened for writing: " + std::strerror(errno)};
  bool good = std::fwrite(text_.data(), 1, text_.size(), file) == text_.size();
  good = std::fclose(file) == 0 && good;
  if (good && !device) good = std::rename(draft.c_str(), path.c_str()) == 0;
  if (good) return success();
  const std::string reason = std::strerror(errno);
  if (!device) std::remove(draft.c_str());
  return Error{Fault::io, path + ": cannot be written: " + reason};
}

}  // namespace face
