#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

#include <filesystem>
#include <fstream>
#include <sstream>
namespace manager {
namespace {

using namespace objdb;

constexpr std::size_t deepest = 32;

// the current folder, beside the script that asks, the installed scenes and figures
Result<std::string> find_file(const Call& call) {
  const std::filesystem::path wanted(call.words[0].text);
  std::vector<std::filesystem::path> places = {wanted};
  if (wanted.is_relative()) {
    const Input* input = call.session->input();
    if (input != nullptr && !input->folder.empty()) places.push_back(std::filesystem::path(input->folder) / wanted);
    const std::filesystem::path programs(call.manager.options().program_folder);
    for (const char* installed : {"../share/virtual_sailor", "../../../scripts"})
      for (const char* folder : {"", "scenes", "figures"}) places.push_back(programs / installed / folder / wanted);
  }
  std::error_code ignored;
  for (const auto& place : places)
    if (std::filesystem::exists(place, ignored) && !std::filesystem::is_directory(place, ignored))
      return place.string();
  if (std::filesystem::is_directory(wanted, ignored))
    return call.error(0, ErrorKind::io, quote(wanted.string()) + " is a folder, expected a script");
  return call.error(0, ErrorKind::io, "no file " + quote(wanted.string()));
}

Outcome run(Call& call) {
  if (call.session == nullptr) return call.error(-1, ErrorKind::busy, "a program cannot source a script");
  if (call.words.size() == 2 || (call.words.size() == 3 && call.words[1].text != "under"))
    return call.error(1, ErrorKind::syntax, "expected source FILE [under PATH]");
  const Result<std::string> file = find_file(call);
  if (!file) return file.error();
  if (call.session->depth() >= deepest)
    return call.error(0, ErrorKind::limit, "scripts source each other more than " + std::to_string(deepest) + " deep");
  std::ifstream stream(*file, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  if (!stream.is_open()) return call.error(0, ErrorKind::io, *file + " cannot be read");

  Input input;
  input.name = *file;
  input.folder = std::filesystem::path(*file).parent_path().string();
  if (input.folder.empty()) input.folder = ".";
  input.text = text.str();
  input.scope = call.scope;
  if (call.words.size() == 3) {
    const std::string path = call.scope.resolve(call.words[2].text);
    Database& world = call.manager.world;
    if (world.find(path) == nullptr) {
      world.speak_as(
          {call.manager.lines.add(call.line), static_cast<std::uint32_t>(call.manager.clock.tick()), call.source.id});
      const Result<ObjectId> made = world.create(world.scene().node_type(), path);
      if (!made) return call.error(2, made.error().kind, made.error().sentence);
    }
    input.scope.prefix = path + "/";
  }
  call.session->interpose(std::move(input));
  return {};
}

}  // namespace

extern const Command command_source;
const Command command_source = {"source",
                                "FILE [under PATH]",
                                "Reads a script; under a path, everything in it is relative to that path, which is "
                                "made a node when it is not there.",
                                Effect::control,
                                1,
                                3,
                                run};

}  // namespace manager
