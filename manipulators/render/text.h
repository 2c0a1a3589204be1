#pragma once

#include <string>
#include <vector>

#include "manipulators/render/picture.h"
#include "manipulators/render/scene.h"

namespace render {

/// Writes UTF-8 text with its upper left corner at (x, y), `height` pixels a line, with a soft dark edge so that it is
/// legible on anything. A line feed starts a new line; what lies outside is clipped; unknown letters show as boxes.
/// The font is the system's "DejaVu Sans Mono" or whatever fontconfig offers in its place; with no font at all
/// nothing is written and false is returned.
bool write_text(Picture& picture, const std::string& text, int x, int y, int height, Rgba color);

/// Width in pixels of the longest line of `text` at that height.
int text_width(const std::string& text, int height);

/// Writes the labels of a scene, scaled to the picture's height.
void write_labels(Picture& picture, const std::vector<Label>& labels);

}  // namespace render
