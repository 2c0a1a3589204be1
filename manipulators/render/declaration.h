#pragma once

#include <string_view>

namespace render {

/// What the renderer brings to a world: types, fields and verbs, in the language itself.
extern const std::string_view declaration;

}  // namespace render
