#include "dialog_manager/programs.h"

#include <algorithm>
#include <csignal>
#include <filesystem>

#include "dialog_manager/manager.h"
#include "dialog_manager/stage_plan.h"

namespace manager {
namespace {

using namespace objdb;
using Wall = channel::Clock;

// a name of the language from the name of a file
std::string name_of_file(const std::string& program) {
  std::string name = std::filesystem::path(program).stem().string();
  for (char& c : name)
    if (!is_name(std::string(1, c)) && !(c >= '0' && c <= '9')) c = '_';
  return is_name(name) ? name : "program_" + name;
}

}  // namespace

Manipulator* Programs::find(std::string_view name) const {
  for (const auto& each : all_)
    if (each->name == name) return each.get();
  return nullptr;
}

std::vector<Manipulator*> Programs::by_name() const {
  std::vector<Manipulator*> out;
  for (const auto& each : all_) out.push_back(each.get());
  std::sort(out.begin(), out.end(), [](const auto* a, const auto* b) { return a->name < b->name; });
  return out;
}

// -- start

Result<std::string> Programs::name_for(const Start& what) const {
  std::string name = what.as.empty() ? name_of_file(what.program) : what.as;
  if (!is_name(name)) return Error{ErrorKind::syntax, quote(name) + " is not a name ([A-Za-z_][A-Za-z0-9_]*)", 0};
  if (is_source_of_manager(name))
    return Error{ErrorKind::exists,
                 name + " is a name of the manager's own, expected another: start " + what.program + " as NAME", 0};
  const Manipulator* known = find(name);
  if (known != nullptr && !known->over())
    return Error{ErrorKind::exists, name + " runs already, expected another name: start " + what.program + " as NAME",
                 0};
  return name;
}

std::vector<std::string> Programs::command_line(const Start& what) const {
  std::vector<std::string> argv = what.launcher;
  std::string path = what.program;
  // beside the manager, then as a path, then on PATH; a launcher finds the program itself
  if (what.launcher.empty() && path.find('/') == std::string::npos) {
    const std::filesystem::path beside = std::filesystem::path(manager_.options().program_folder) / path;
    std::error_code ignored;
    if (std::filesystem::exists(beside, ignored))
      path = beside.string();
    else if (std::filesystem::is_regular_file(path, ignored))
      path = "./" + path;
  }
  argv.push_back(std::move(path));
  argv.insert(argv.end(), what.arguments.begin(), what.arguments.end());
  return argv;
}

Result<Manipulator*> Programs::start(Start what) {
  const Result<std::string> name = name_for(what);
  if (!name) return name.error();
  // who ended under this name makes room
  if (Manipulator* over = find(*name)) drop(*over);
  auto manipulator = std::make_unique<Manipulator>(manager_, *name, what.program, command_line(what), what.serving);
  manipulator->id = manager_.add_source(*name);
  const channel::Spare spare;
  if (!spare.held()) return Error{ErrorKind::limit, what.program + " cannot be started: too many open files", 0};
  if (Status launched = manipulator->launch(); !launched) return launched.error();
  all_.push_back(std::move(manipulator));
  return all_.back().get();
}

// -- who stands where

void Programs::drop(Manipulator& manipulator) {
  const std::uint16_t id = manipulator.id;
  Database& world = manager_.world;
  world.for_each("**", [&](const Object& object) {
    for (std::size_t i = 0; i < object.slots.size(); ++i)
      if (object.slots[i].owner == id) world.set_owner(object, static_cast<int>(i), 0);
  });
  std::erase_if(all_, [&](const auto& each) { return each.get() == &manipulator; });
  (void)arrange();
}

Status Programs::arrange() {
  std::vector<Manipulator*> members;
  std::vector<StageMember> plan;
  for (const auto& each : all_) {
    if (each->state() == Manipulator::State::failed) continue;
    members.push_back(each.get());
    plan.push_back({each->name, each->program(), &each->declared()});
  }
  const Result<std::vector<int>> stage = plan_stages(manager_.world, plan);
  if (!stage) return stage.error();
  stages_ = 0;
  for (std::size_t i = 0; i < members.size(); ++i) {
    members[i]->stage = (*stage)[i];
    stages_ = std::max(stages_, (*stage)[i] + 1);
  }
  return {};
}

void Programs::schema_changed() {
  for (const auto& each : all_) each->schema_changed();
}

// -- the loop

bool Programs::step() {
  bool did = false;
  for (const auto& each : all_) {
    each->check_deadline();
    did |= each->step();
  }
  return did;
}

std::optional<Wall::time_point> Programs::deadline() const {
  std::optional<Wall::time_point> first;
  for (const auto& each : all_)
    if (const auto deadline = each->deadline(); deadline && (!first || *deadline < *first)) first = deadline;
  return first;
}

void Programs::flush() {
  for (const auto& each : all_) each->flush();
}

// -- the end

void Programs::kill_all() {
  while (!all_.empty()) all_.pop_back();
  stages_ = 0;
}

void Programs::end_all() {
  for (auto each = all_.rbegin(); each != all_.rend(); ++each) (*each)->quit();
  // quit, 2 s, SIGTERM, 2 s, SIGKILL
  const auto start = Wall::now();
  bool terminated = false;
  while (true) {
    bool alive = false;
    for (const auto& each : all_) {
      each->step();
      each->flush();
      alive |= each->alive();
    }
    const auto waited = Wall::now() - start;
    if (!alive || waited > std::chrono::seconds(4)) break;
    if (waited > std::chrono::seconds(2) && !terminated) {
      terminated = true;
      for (const auto& each : all_)
        if (each->alive()) ::kill(-each->pid(), SIGTERM);
    }
    manager_.loop().wait(Wall::now() + std::chrono::milliseconds(50));
  }
  kill_all();
}

}  // namespace manager
