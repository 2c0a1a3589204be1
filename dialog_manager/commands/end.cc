#include "dialog_manager/command.h"
#include "dialog_manager/manager.h"

#include <csignal>
namespace manager {
namespace {

using namespace objdb;

// it writes down its state; then quit, 2 s, SIGTERM, 2 s, SIGKILL
class Ending : public Operation {
 public:
  explicit Ending(std::string program) : program_(std::move(program)) {}
  std::optional<Status> poll(Manager& manager, std::string&) override {
    Manipulator* manipulator = manager.programs.find(program_);
    if (manipulator == nullptr) return Status();
    if (!asked_) {
      if (!manager.resting()) return std::nullopt;
      manipulator->quit();
      asked_ = channel::Clock::now();
    }
    const auto waited = channel::Clock::now() - *asked_;
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
    if (!asked_) return std::nullopt;
    return *asked_ + std::chrono::milliseconds(terminated_ ? 4001 : 2001);
  }

 private:
  std::string program_;
  std::optional<channel::Clock::time_point> asked_;
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
  call.manager.write_down(manipulator);
  return std::make_unique<Ending>(manipulator->name);
}

}  // namespace

extern const Command command_end;
const Command command_end = {"end",
                             "NAME",
                             "Ends a manipulator, after it has written down its private state, with which another "
                             "start goes on. Its fields keep "
                             "their values and are free for another writer.",
                             Effect::time,
                             1,
                             1,
                             run};

}  // namespace manager
