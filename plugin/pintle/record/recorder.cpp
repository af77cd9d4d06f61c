#include <pintle/record/observer.h>
#include <pintle/record/recording.h>
#include <pintle/record/shapes.h>

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace record {

[[noreturn]] void rejectOption(const char* option, double value, const char* right) {
  std::ostringstream message;
  message << "Recorder: " << option << " is " << value << ", it must be " << right;
  throw std::invalid_argument(message.str());
}

bool isColour(const std::string& text) {
  return text.size() == 7 && text[0] == '#' &&
         text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
}

RecorderOptions checked(RecorderOptions options) {
  if (!(options.frames_per_second > 0 && std::isfinite(options.frames_per_second)))
    rejectOption("frames_per_second", options.frames_per_second, "finite and > 0");
  if (options.max_bytes == 0) rejectOption("max_bytes", 0, "> 0");
  if (options.name.empty()) throw std::invalid_argument("Recorder: name is empty");
  if (options.scene.empty()) throw std::invalid_argument("Recorder: scene is empty");
  if (!options.colour.empty() && !isColour(options.colour))
    throw std::invalid_argument("Recorder: colour is \"" + options.colour +
                                "\", it must be as \"#0072b2\"");
  return options;
}

RecorderOptions named(const std::string& name) {
  RecorderOptions options;
  options.name = name;
  return options;
}

}  // namespace record

class Recorder::Impl {
 public:
  Impl(btDynamicsWorld& world, RecorderOptions options)
      : m_observer(world, record::checked(std::move(options))) {}

  record::Observer m_observer;
};

Recorder::Recorder(btDynamicsWorld& world, RecorderOptions options)
    : m_impl(std::make_unique<Impl>(world, std::move(options))) {}
Recorder::Recorder(btDynamicsWorld& world, const std::string& name)
    : Recorder(world, record::named(name)) {}
Recorder::~Recorder() = default;

void Recorder::begin() { m_impl->m_observer.begin(); }
void Recorder::step() { m_impl->m_observer.step(); }

void Recorder::addFigure(const std::string& name, const std::string& unit, double value) {
  if (name.empty()) throw std::invalid_argument("Recorder: a figure has no name");
  m_impl->m_observer.recording().figures.push_back({name, unit, value});
}

int Recorder::getNumFrames() const { return int(m_impl->m_observer.recording().frames.size()); }
int Recorder::getStride() const { return m_impl->m_observer.recording().stride; }
std::size_t Recorder::getNumBytes() const { return m_impl->m_observer.bytes(); }
double Recorder::getTime() const { return m_impl->m_observer.time(); }
std::string Recorder::toJson() const { return m_impl->m_observer.recording().json(); }

}  // namespace PINTLE_PRECISION
}  // namespace pintle
