#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

#include <filesystem>
namespace manager {
namespace {

using namespace objdb;

Outcome run(Call& call) {
  Journal* journal = call.manager.recorder.journal();
  if (journal == nullptr) return call.error(-1, ErrorKind::io, "branch needs a journal, expected journal FILE before");
  if (Status kept = journal->flush(true); !kept) return kept.error();
  const Result<JournalText> text = read_journal(journal->path());
  if (!text) return call.error(0, text.error().kind, text.error().sentence);
  std::error_code error;
  const std::string to(call.words[0].text);
  std::filesystem::copy_file(journal->path(), to, error);
  const std::string arrays = ArrayFile::path_of(journal->path());
  std::error_code none;
  if (!error && std::filesystem::exists(arrays, none))
    std::filesystem::copy_file(arrays, ArrayFile::path_of(to), error);
  if (!error)
    std::filesystem::permissions(to, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write, error);
  if (!error) std::filesystem::resize_file(to, text->good, error);
  if (error) return call.error(0, ErrorKind::io, to + " cannot be written: " + error.message());
  return {};
}

}  // namespace

extern const Command command_branch;
const Command command_branch = {
    "branch",
    "FILE",
    "Writes the journal so far to another file, from which a second story can go on: --resume FILE.",
    Effect::control,
    1,
    1,
    run};

}  // namespace manager
