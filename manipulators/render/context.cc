#include "manipulators/render/context.h"

#include <GL/osmesa.h>

#include <array>

namespace render {

namespace {

class OsmesaContext : public Context {
 public:
  explicit OsmesaContext(OSMesaContext context) : context_(context) {}
  ~OsmesaContext() override { OSMesaDestroyContext(context_); }
  OsmesaContext(const OsmesaContext&) = delete;
  OsmesaContext& operator=(const OsmesaContext&) = delete;

  std::string use() override {
    if (OSMesaGetCurrentContext() == context_) return {};
    // pictures are drawn into frame buffer objects; the buffer that OSMesa insists on stays tiny
    if (!OSMesaMakeCurrent(context_, buffer_.data(), GL_UNSIGNED_BYTE, side, side)) {
      return "OSMesa cannot make its context current";
    }
    auto word = [](GLenum name) {
      const GLubyte* text = glGetString(name);
      return std::string(text ? reinterpret_cast<const char*>(text) : "?");
    };
    description_ = word(GL_VERSION) + ", " + word(GL_RENDERER);
    return {};
  }

  std::string description() const override { return description_; }

 private:
  static constexpr int side = 8;
  OSMesaContext context_;
  std::array<unsigned char, side * side * 4> buffer_{};
  std::string description_;
};

}  // namespace

std::unique_ptr<Context> make_osmesa_context(std::string& problem) {
  const int attributes[] = {OSMESA_FORMAT,
                            OSMESA_RGBA,
                            OSMESA_DEPTH_BITS,
                            24,
                            OSMESA_PROFILE,
                            OSMESA_CORE_PROFILE,
                            OSMESA_CONTEXT_MAJOR_VERSION,
                            3,
                            OSMESA_CONTEXT_MINOR_VERSION,
                            3,
                            0};
  OSMesaContext raw = OSMesaCreateContextAttribs(attributes, nullptr);
  if (!raw) {
    problem = "OSMesa offers no OpenGL 3.3 core context";
    return nullptr;
  }
  auto context = std::make_unique<OsmesaContext>(raw);
  problem = context->use();
  if (!problem.empty()) return nullptr;
  return context;
}

}  // namespace render
