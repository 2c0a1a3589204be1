#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

namespace manager {
namespace {

using namespace objdb;

class Starting : public Operation {
 public:
  explicit Starting(std::string program) : program_(std::move(program)) {}
  std::optional<Status> poll(Manager& manager, std::string&) override {
    Manipulator* manipulator = manager.programs.find(program_);
    if (manipulator == nullptr) return Status(Error{ErrorKind::gone, program_ + " is gone", 0});
    if (manipulator->state() == Manipulator::State::failed) {
      const Error error = manipulator->failure();
      manager.programs.drop(*manipulator);
      return Status(error);
    }
    if (manipulator->state() == Manipulator::State::active) return Status();
    return std::nullopt;
  }

 private:
  std::string program_;
};

bool is_keyword(const Word& word) {
  return !word.quoted && (word.text == "as" || word.text == "with" || word.text == "serving" || word.text == "--");
}

Outcome run(Call& call) {
  Programs::Start what;
  what.program = call.words[0].text;
  for (std::size_t at = 1; at < call.words.size();) {
    const Word& keyword = call.words[at++];
    if (!is_keyword(keyword))
      return call.error(static_cast<int>(at) - 1, ErrorKind::syntax,
                        "unexpected " + quote(keyword.text) + ", expected as, with, serving or --");
    if (keyword.text == "--") {
      for (; at < call.words.size(); ++at) what.arguments.emplace_back(call.words[at].text);
      break;
    }
    const std::size_t first = at;
    if (keyword.text == "with") {
      while (at < call.words.size() && !is_keyword(call.words[at])) what.launcher.emplace_back(call.words[at++].text);
    } else if (at < call.words.size()) {
      (keyword.text == "as" ? what.as : what.serving) = call.words[at++].text;
    }
    if (at == first)
      return call.error(static_cast<int>(first) - 1, ErrorKind::syntax,
                        "expected a word after " + std::string(keyword.text));
  }
  if (!what.serving.empty()) what.serving = call.scope.resolve(what.serving);
  const Result<Manipulator*> started = call.manager.programs.start(std::move(what));
  if (!started) return call.error(0, started.error().kind, started.error().sentence);
  (*started)->command = call.line;
  return std::make_unique<Starting>((*started)->name);
}

}  // namespace

extern const Command command_start;
const Command command_start = {"start",
                               "PROGRAM [as NAME] [with LAUNCHER...] [serving PATTERN] [-- ARG...]",
                               "Starts a manipulator and waits until it is ready. It is looked for beside "
                               "dialog_manager, then as a path, then on PATH.",
                               Effect::time,
                               1,
                               any_number,
                               run};

}  // namespace manager
