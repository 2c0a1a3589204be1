#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

#include <csignal>
namespace manager {
namespace {

using namespace objdb;

// quit, 2 s, SIGTERM, 2 s, SIGKILL
class Ending : public Operation {
 public:
  explicit Ending(std::string program) : program_(std::move(program)), asked_(channel::Clock::now()) {}
  std::optional<Status> poll(Manager& manager, std::string&) override {
    Manipulator* manipulator = manager.programs.find(program_);
    if (manipulator == nullptr) return Status();
    const auto waited = channel::Clock::now() - asked_;
    if (manipulator->alive() && waited < std::chrono::seconds(4)) {
      if (waited > std::chrono::seconds(2) && !terminated_) {
        terminated_ = true;
        ::kill(-manipulator->pid(), SIGTERM);
      }
      return std::nullopt;
    }
    manager.programs.drop(*manipulator);
    return Status();
  }
  std::optional<channel::Clock::time_point> deadline() const override {
    return asked_ + std::chrono::milliseconds(terminated_ ? 4001 : 2001);
  }

 private:
  std::string program_;
  channel::Clock::time_point asked_;
  bool terminated_ = false;
};

Outcome run(Call& call) {
  Manipulator* manipulator = call.manager.programs.find(call.words[0].text);
  if (manipulator == nullptr) {
    std::vector<std::string_view> names;
    for (const auto& each : call.manager.programs.all()) names.push_back(each->name);
    return call.error(0, ErrorKind::unknown,
                      "no manipulator " + quote(call.words[0].text) + did_you_mean(call.words[0].text, names));
  }
  manipulator->quit();
  return std::make_unique<Ending>(manipulator->name);
}

}  // namespace

extern const Command command_end;
const Command command_end = {
    "end", "NAME", "Ends a manipulator. Its fields keep their values and are free for another writer.", Effect::time, 1,
    1,     run};

}  // namespace manager
