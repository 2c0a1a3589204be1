#include "dialog_manager/script_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <vector>

#include "objdb/text.h"

namespace manager {

using namespace objdb;

Result<std::string> find_script(const std::string& name, const std::string& beside, const std::string& program_folder) {
  const std::filesystem::path wanted(name);
  std::vector<std::filesystem::path> places = {wanted};
  if (wanted.is_relative()) {
    if (!beside.empty()) places.push_back(std::filesystem::path(beside) / wanted);
    for (const std::string& folder : script_folders(program_folder))
      places.push_back((std::filesystem::path(folder) / wanted).lexically_normal());
  }
  std::error_code ignored;
  for (const auto& place : places)
    if (std::filesystem::exists(place, ignored) && !std::filesystem::is_directory(place, ignored))
      return place.string();
  if (std::filesystem::is_directory(wanted, ignored))
    return Error{ErrorKind::io, shown(name) + " is a folder, expected a script", 0};
  return Error{ErrorKind::io, "no file " + shown(name), 0};
}

std::vector<std::string> script_folders(const std::string& program_folder) {
  std::vector<std::string> out;
  for (const char* installed : {"../share/virtual_sailor", "../../../scripts"})
    for (const char* folder : {"", "scenes", "figures"})
      out.push_back((std::filesystem::path(program_folder) / installed / folder).lexically_normal().string());
  return out;
}

Result<std::string> read_script(const std::string& path) {
  const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  const auto failed = [&] { return Error{ErrorKind::io, shown(path) + " cannot be read: " + std::strerror(errno), 0}; };
  if (file < 0) return failed();
  std::string text;
  constexpr std::size_t longest = 256u << 20;
  std::array<char, 65536> block;
  while (true) {
    const ssize_t count = ::read(file, block.data(), block.size());
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) {
      const Error error = failed();
      ::close(file);
      return error;
    }
    if (count == 0) break;
    text.append(block.data(), static_cast<std::size_t>(count));
    if (text.size() > longest) {
      ::close(file);
      return Error{ErrorKind::limit, shown(path) + " is longer than 256 MiB, expected a script", 0};
    }
  }
  ::close(file);
  return text;
}

}  // namespace manager
