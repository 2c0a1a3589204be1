#include "dialog_manager/budget.h"

#include "objdb/text.h"

namespace manager {

std::string Budget::line() const {
  if (of == Of::nothing) return "budget off";
  return std::string("budget ") + (of == Of::error ? "error " : "time ") + objdb::number(value);
}

}  // namespace manager
