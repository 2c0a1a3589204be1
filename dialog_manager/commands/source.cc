#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"
#include "dialog_manager/script_file.h"

#include <filesystem>
namespace manager {
namespace {

using namespace objdb;

constexpr std::size_t deepest = 32;

Outcome run(Call& call) {
  if (call.session == nullptr) return call.error(-1, ErrorKind::busy, "a program cannot source a script");
  if (call.words.size() == 2 || (call.words.size() == 3 && call.words[1].text != "under"))
    return call.error(1, ErrorKind::syntax, "expected source FILE [under PATH]");
  const Input* asking = call.session->input();
  const Result<std::string> file = find_script(std::string(call.words[0].text), asking == nullptr ? "" : asking->folder,
                                               call.manager.options().program_folder);
  if (!file) return call.error(0, file.error().kind, file.error().sentence);
  if (call.session->depth() >= deepest)
    return call.error(0, ErrorKind::limit, "scripts source each other more than " + std::to_string(deepest) + " deep");
  // a pipe may never end, and everybody would wait for it
  std::error_code ignored;
  if (std::filesystem::is_fifo(*file, ignored))
    return call.error(0, ErrorKind::io, *file + " is a FIFO, expected a script; listen hears a FIFO");
  Result<std::string> text = read_script(*file);
  if (!text) return call.error(0, text.error().kind, text.error().sentence);

  Input input;
  input.name = *file;
  input.folder = std::filesystem::path(*file).parent_path().string();
  if (input.folder.empty()) input.folder = ".";
  input.text = std::move(*text);
  input.scope = call.scope;
  if (call.words.size() == 3) {
    const std::string path = call.scope.resolve(call.words[2].text);
    Database& world = call.manager.world;
    if (world.find(path) == nullptr) {
      // a command of its own, which is kept and taken back like any other
      const std::string line = "create node " + path;
      LineWords words;
      std::string nothing;
      if (Status split = words.split(line); !split) return call.error(2, split.error().kind, split.error().sentence);
      const Outcome made = call.manager.dispatch.execute(call.source, call.session, words, line, {}, nothing);
      if (!made.status) return call.error(2, made.status.error().kind, made.status.error().sentence);
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
