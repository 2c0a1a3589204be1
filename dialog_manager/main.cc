#include <fcntl.h>
#include <malloc.h>
#include <sys/stat.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iostream>

#include "dialog_manager/count.h"
#include "dialog_manager/manager.h"
#include "dialog_manager/script_file.h"

namespace {

// descriptors 0 to 2 are always open, so that no file or pipe of ours ever takes their place
void open_standard_streams() {
  while (true) {
    const int descriptor = ::open("/dev/null", O_RDWR);
    if (descriptor > STDERR_FILENO) {
      ::close(descriptor);
      return;
    }
    if (descriptor < 0) return;
  }
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_streams();
  // a broken pipe and a full quota are errors of a write, not ends of the program
  ::signal(SIGPIPE, SIG_IGN);
  ::signal(SIGXFSZ, SIG_IGN);
  // a long array that comes every tick takes memory that is there already
  ::mallopt(M_MMAP_THRESHOLD, 4 << 20);
  ::mallopt(M_TRIM_THRESHOLD, 16 << 20);

  manager::Options options;
  std::vector<std::string> scripts, commands;
  CLI::App app("The dialog manager of The Virtual Sailor: a typed world, the programs that move it, and time.",
               "dialog_manager");
  CLI::Option* script_option = app.add_option("SCRIPT", scripts, "scripts to run, in order");
  CLI::Option* command_option = app.add_option("-c", commands, "a command to run")->allow_extra_args(false)->take_all();
  app.add_flag("-i,--interactive", options.interactive, "a prompt after scripts and commands");
  app.add_flag("--framed", options.framed, "replies for programs: framed and tagged");
  app.add_flag("--keep-going", options.keep_going, "go on after an error (the exit status is 1 all the same)");
  std::string seed = "0";
  app.add_option("--seed", seed, "given to every program, 0 to 2^64 - 1 (default 0)");
  CLI::Option* journal_option = app.add_option("--journal", options.journal, "keep every accepted line in this file");
  app.add_option("--resume", options.resume, "go on where this journal ends")->excludes(journal_option);
  std::string pace = "fast";
  app.add_option("--pace", pace, "fast, realtime, or simulated seconds a second");
  app.add_flag("--check", options.check, "read and check scripts and commands, change nothing");
  app.set_version_flag("--version", "dialog_manager " SAILOR_VERSION);
  bool no_rc = false;
  app.add_flag("--norc", no_rc, "do not read ~/.dialog_managerrc at the prompt");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int status = app.exit(error);
    return status == 0 ? 0 : 2;
  }

  const std::optional<std::uint64_t> seed_number = manager::parse_count(seed);
  if (!seed_number) {
    std::cerr << "--seed: " << seed << " is no seed, expected a whole number from 0 to 2^64 - 1\n";
    return 2;
  }
  options.seed = *seed_number;
  if (pace == "realtime") {
    options.pace = 1;
  } else if (pace != "fast") {
    const objdb::Result<double> value = objdb::parse_real(pace, {});
    if (!value || !manager::Clock::is_pace(*value)) {
      std::cerr << "--pace: " << pace << " is no pace, expected fast, realtime or a number from 1e-6 to 1e6\n";
      return 2;
    }
    options.pace = *value;
  }
  options.program_folder = std::filesystem::read_symlink("/proc/self/exe").parent_path().string();
  // scripts and commands run in the order in which they stand
  std::size_t next_script = 0, next_command = 0;
  for (const CLI::Option* option : app.parse_order()) {
    if (option == script_option && next_script < scripts.size()) {
      const std::string& name = scripts[next_script++];
      const objdb::Result<std::string> path = manager::find_script(name, "", options.program_folder);
      const objdb::Result<std::string> text = path ? manager::read_script(*path) : path;
      if (!text) {
        std::cerr << "dialog_manager: error io " << text.error().sentence << "\n";
        return 2;
      }
      options.texts.push_back({*path, *text, true});
    } else if (option == command_option && next_command < commands.size()) {
      options.texts.push_back({"-c", commands[next_command++], false});
    }
  }
  options.read_input = options.texts.empty() || options.interactive;
  options.terminal =
      options.read_input && !options.framed && ::isatty(STDIN_FILENO) != 0 && ::isatty(STDOUT_FILENO) != 0;
  options.interactive = options.interactive || options.terminal;
  if (options.terminal && !no_rc)
    if (const char* home = std::getenv("HOME"); home != nullptr)
      if (const objdb::Result<std::string> text = manager::read_script(std::string(home) + "/.dialog_managerrc"))
        options.texts.insert(options.texts.begin(), {std::string(home) + "/.dialog_managerrc", *text, true});
  struct stat input {};
  if (options.read_input && ::fstat(STDIN_FILENO, &input) == 0 && S_ISDIR(input.st_mode)) {
    std::cerr << "dialog_manager: error io standard input is a folder\n";
    return 1;
  }
  manager::Manager manager(std::move(options));
  return manager.run();
}
