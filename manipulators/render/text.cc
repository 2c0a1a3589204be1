#include "manipulators/render/text.h"

#include <fontconfig/fontconfig.h>
#include <ft2build.h>
#include FT_FREETYPE_H

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>

namespace render {

namespace {

struct Glyph {
  int left = 0, top = 0, width = 0, height = 0, advance = 0;
  std::vector<std::uint8_t> cover;
};

std::string font_file() {
  FcConfig* config = FcInitLoadConfigAndFonts();
  if (!config) return {};
  FcPattern* wanted = FcNameParse(reinterpret_cast<const FcChar8*>("DejaVu Sans Mono"));
  FcConfigSubstitute(config, wanted, FcMatchPattern);
  FcDefaultSubstitute(wanted);
  FcResult result;
  FcPattern* found = FcFontMatch(config, wanted, &result);
  std::string file;
  FcChar8* name = nullptr;
  if (found && FcPatternGetString(found, FC_FILE, 0, &name) == FcResultMatch) file = reinterpret_cast<char*>(name);
  if (found) FcPatternDestroy(found);
  FcPatternDestroy(wanted);
  FcConfigDestroy(config);
  return file;
}

// the font and the letters drawn so far
class Font {
 public:
  Font() {
    const std::string file = font_file();
    if (file.empty() || FT_Init_FreeType(&library_) != 0) return;
    if (FT_New_Face(library_, file.c_str(), 0, &face_) != 0) face_ = nullptr;
  }
  ~Font() {
    if (face_) FT_Done_Face(face_);
    if (library_) FT_Done_FreeType(library_);
  }
  Font(const Font&) = delete;
  Font& operator=(const Font&) = delete;

  bool usable() const { return face_ != nullptr; }

  const Glyph& glyph(char32_t letter, int height) {
    Glyph& glyph = glyphs_[{letter, height}];
    if (glyph.advance != 0) return glyph;
    FT_Set_Pixel_Sizes(face_, 0, static_cast<FT_UInt>(std::max(4, height * 4 / 5)));
    glyph.advance = 1;
    if (FT_Load_Char(face_, letter, FT_LOAD_RENDER) != 0) return glyph;
    const FT_GlyphSlot slot = face_->glyph;
    glyph.left = slot->bitmap_left;
    glyph.top = slot->bitmap_top;
    glyph.width = static_cast<int>(slot->bitmap.width);
    glyph.height = static_cast<int>(slot->bitmap.rows);
    glyph.advance = std::max<int>(1, static_cast<int>(slot->advance.x / 64));
    for (int row = 0; row < glyph.height; ++row) {
      const std::uint8_t* line = slot->bitmap.buffer + row * slot->bitmap.pitch;
      glyph.cover.insert(glyph.cover.end(), line, line + glyph.width);
    }
    return glyph;
  }

 private:
  FT_Library library_ = nullptr;
  FT_Face face_ = nullptr;
  std::map<std::pair<char32_t, int>, Glyph> glyphs_;
};

Font& font() {
  static Font the_font;
  return the_font;
}

// windows write labels from threads of their own
std::mutex& font_mutex() {
  static std::mutex mutex;
  return mutex;
}

// decodes one letter at `at` and steps over it; a broken sequence yields U+FFFD and one byte
char32_t next_letter(const std::string& text, std::size_t& at) {
  const auto first = static_cast<unsigned char>(text[at++]);
  if (first < 0x80) return first;
  const int more = first >= 0xf0 ? 3 : first >= 0xe0 ? 2 : first >= 0xc0 ? 1 : 0;
  if (more == 0) return 0xfffd;
  char32_t letter = first & (0x3f >> more);
  for (int i = 0; i < more; ++i) {
    if (at >= text.size() || (static_cast<unsigned char>(text[at]) & 0xc0) != 0x80) return 0xfffd;
    letter = letter << 6 | (static_cast<unsigned char>(text[at++]) & 0x3f);
  }
  return letter;
}

void blend(Picture& picture, int x, int y, Rgba color, float amount) {
  if (x < 0 || y < 0 || x >= picture.width() || y >= picture.height()) return;
  Rgba under = picture.at(x, y);
  for (int c = 0; c < 3; ++c) {
    const float value =
        static_cast<float>(under[c]) + amount * (static_cast<float>(color[c]) - static_cast<float>(under[c]));
    under[c] = static_cast<std::uint8_t>(value + 0.5f);
  }
  picture.put(x, y, under);
}

// calls draw(glyph, pen x, baseline y) for each letter
template <typename Draw>
void for_each_letter(const std::string& text, int x, int y, int height, Draw draw) {
  int pen = x;
  int baseline = y + height * 4 / 5;
  for (std::size_t at = 0; at < text.size();) {
    const char32_t letter = next_letter(text, at);
    if (letter == '\n') {
      pen = x;
      baseline += height;
      continue;
    }
    const Glyph& glyph = font().glyph(letter, height);
    draw(glyph, pen, baseline);
    pen += glyph.advance;
  }
}

}  // namespace

bool write_text(Picture& picture, const std::string& text, int x, int y, int height, Rgba color) {
  const std::lock_guard lock(font_mutex());
  if (!font().usable()) return false;
  const int edge = std::max(1, height / 14);
  const float strength = static_cast<float>(color[3]) / 255;
  // a dark copy in eight directions first, then the letters
  for_each_letter(text, x, y, height, [&](const Glyph& glyph, int pen, int baseline) {
    for (int row = 0; row < glyph.height; ++row) {
      for (int column = 0; column < glyph.width; ++column) {
        const float cover = static_cast<float>(glyph.cover[row * glyph.width + column]) / 255;
        if (cover == 0) continue;
        for (int dy = -edge; dy <= edge; dy += edge) {
          for (int dx = -edge; dx <= edge; dx += edge) {
            blend(picture, pen + glyph.left + column + dx, baseline - glyph.top + row + dy, {12, 18, 28, 255},
                  cover * 0.35f * strength);
          }
        }
      }
    }
  });
  for_each_letter(text, x, y, height, [&](const Glyph& glyph, int pen, int baseline) {
    for (int row = 0; row < glyph.height; ++row) {
      for (int column = 0; column < glyph.width; ++column) {
        const float cover = static_cast<float>(glyph.cover[row * glyph.width + column]) / 255;
        blend(picture, pen + glyph.left + column, baseline - glyph.top + row, color, cover * strength);
      }
    }
  });
  return true;
}

int text_width(const std::string& text, int height) {
  const std::lock_guard lock(font_mutex());
  if (!font().usable()) return 0;
  int widest = 0;
  for_each_letter(text, 0, 0, height,
                  [&](const Glyph& glyph, int pen, int) { widest = std::max(widest, pen + glyph.advance); });
  return widest;
}

void write_labels(Picture& picture, const std::vector<Label>& labels) {
  const float scale = static_cast<float>(picture.height()) / 720;
  for (const Label& label : labels) {
    const int height = std::max(7, static_cast<int>(std::lround(label.size * scale)));
    int x = static_cast<int>(std::lround(label.x * scale));
    int y = static_cast<int>(std::lround(label.y * scale));
    if (label.x < 0) x += picture.width() - text_width(label.text, height);
    if (label.y < 0) y += picture.height() - height;
    write_text(picture, label.text, x, y, height, label.color);
  }
}

}  // namespace render
