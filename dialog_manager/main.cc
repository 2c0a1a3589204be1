#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>

#include "dialog_manager/manager.h"

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

bool read_file(const std::string& path, std::string& text, std::string& why) {
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    why = std::strerror(errno);
    return false;
  }
  if (S_ISDIR(status.st_mode)) {
    why = "it is a folder";
    return false;
  }
  std::ifstream file(path, std::ios::binary);
  std::stringstream content;
  if (!file || !(content << file.rdbuf()).good()) {
    // an empty file sets failbit on <<, and is a script all the same
    if (file.is_open() && status.st_size == 0) return true;
    why = "it cannot be read";
    return false;
  }
  text = content.str();
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  open_standard_streams();
  ::signal(SIGPIPE, SIG_IGN);

  manager::Options options;
  std::vector<std::string> scripts, commands;
  CLI::App app("The dialog manager of The Virtual Sailor: a typed world, the programs that move it, and time.",
               "dialog_manager");
  CLI::Option* script_option = app.add_option("SCRIPT", scripts, "scripts to run, in order");
  CLI::Option* command_option = app.add_option("-c", commands, "a command to run")->allow_extra_args(false)->take_all();
  app.add_flag("-i,--interactive", options.interactive, "a prompt after scripts and commands");
  app.add_flag("--framed", options.framed, "replies for programs: framed and tagged");
  app.add_flag("--keep-going", options.keep_going, "go on after an error (the exit status is 1 all the same)");
  app.add_option("--seed", options.seed, "given to every program (default 0)");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const int status = app.exit(error);
    return status == 0 ? 0 : 2;
  }

  options.program_folder = std::filesystem::read_symlink("/proc/self/exe").parent_path().string();
  // scripts and commands run in the order in which they stand
  std::size_t next_script = 0, next_command = 0;
  for (const CLI::Option* option : app.parse_order()) {
    if (option == script_option && next_script < scripts.size()) {
      manager::Options::Text text{scripts[next_script++], {}, true};
      std::string why;
      if (!read_file(text.name, text.text, why)) {
        std::cerr << "dialog_manager: error io " << text.name << " cannot be read: " << why << "\n";
        return 2;
      }
      options.texts.push_back(std::move(text));
    } else if (option == command_option && next_command < commands.size()) {
      options.texts.push_back({"-c", commands[next_command++], false});
    }
  }
  options.read_input = options.texts.empty() || options.interactive;
  struct stat input {};
  if (options.read_input && ::fstat(STDIN_FILENO, &input) == 0 && S_ISDIR(input.st_mode)) {
    std::cerr << "dialog_manager: error io standard input is a folder\n";
    return 1;
  }
  manager::Manager manager(std::move(options));
  return manager.run();
}
