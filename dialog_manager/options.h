#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace manager {

/// How the program was started.
struct Options {
  struct Text {
    std::string name;
    std::string text;
    bool file = false;
  };
  std::vector<Text> texts;   ///< scripts and -c commands, in order
  bool interactive = false;  ///< a prompt (after the texts)
  bool terminal = false;     ///< the prompt is on a terminal
  bool read_input = false;   ///< commands from standard input
  bool framed = false;
  bool keep_going = false;
  std::uint64_t seed = 0;
  std::string journal;  ///< file to keep every accepted line in
  std::string resume;   ///< journal to go on with
  double pace = 0;
  bool check = false;          ///< read and check everything, change nothing
  std::string program_folder;  ///< where dialog_manager lies: programs are looked for beside it
};

}  // namespace manager
