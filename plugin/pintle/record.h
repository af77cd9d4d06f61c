// Purpose: records a Bullet world while it runs, and writes it as one page that plays it in any browser.
#pragma once

#include <pintle/precision.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

class btDynamicsWorld;

namespace pintle {
inline namespace PINTLE_PRECISION {

/// What a recording is called, how often it looks and how much it may remember.
struct RecorderOptions {
  std::string name = "run";     ///< of this run; runs of one scene are told apart by it
  std::string scene = "world";  ///< runs of one scene are shown side by side
  std::string title;            ///< of the scene; empty: its name
  std::string text;             ///< a sentence about the scene
  std::string group;            ///< of scenes, in the page's gallery
  std::string detail;           ///< of this run, such as its solver
  std::string colour;           ///< of this run, "#rrggbb"; empty: the page chooses
  /// Frames a second of simulated time (> 0, finite). A step that is longer is a frame.
  double frames_per_second = 30;
  /// Of memory (> 0). When they are full every second frame is dropped, and frames come half as often from then
  /// on; at least four are kept.
  std::size_t max_bytes = std::size_t(64) << 20;
  /// Whether constraints without a btJointFeedback get one while they are recorded, so that the force at the joint
  /// is known. Else their impulse is Bullet's getAppliedImpulse(), that of the last row. Constraints that get one
  /// must stay alive as long as the recorder.
  bool measure_forces = false;
};

/// Records any Bullet world: shapes, poses, constraints of every type, contacts, energy, momentum and impulses.
///
///     pintle::Recorder record(world);               // when the world is complete: its poses are the first frame
///     for (...) { world.stepSimulation(dt); record.step(); }
///     record.write("run.html");
///
/// The page opens by itself in a browser, without a network. Bodies and constraints may come and go; poses that
/// are not finite are said, not drawn. Shapes that are no box, sphere, capsule, cylinder, cone, plane, compound,
/// convex hull or triangle mesh are drawn as the hull or the box around them. Constraints are described as they are
/// when they are first seen in a step. A body that is deleted and another one at the same address are told apart by
/// their shapes alone.
///
/// The world outlives the recorder, which adds a btActionInterface to it to see the time of each substep. The
/// world's numbers do not change. Used from the thread that steps the world.
class Recorder {
 public:
  /// Throws std::invalid_argument if a setting is out of its range.
  explicit Recorder(btDynamicsWorld& world, RecorderOptions options = {});
  /// The same, with a name of the run.
  Recorder(btDynamicsWorld& world, const std::string& name);
  ~Recorder();
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// Before stepSimulation, if the time of steps is to be recorded, too.
  void begin();
  /// After stepSimulation. Nothing if that made no substep.
  void step();

  /// A number of this run that the program knows, for the page's table. Throws std::invalid_argument without a name.
  void addFigure(const std::string& name, const std::string& unit, double value);

  /// Of frames that are kept.
  int getNumFrames() const;
  /// 1, 2, 4, ...: of so many frames one is kept.
  int getStride() const;
  /// Of memory, of all frames.
  std::size_t getNumBytes() const;
  /// s, of simulated time, since the recorder was made.
  double getTime() const;

  /// Writes a page with this run. The page's template is `page_template`, if given; else what the environment
  /// variable PINTLE_PAGE_TEMPLATE names; else the one that Pintle's CMake target knows. Throws
  /// std::runtime_error if there is none, or if the file can't be written.
  void write(const std::string& path, const std::string& page_template = {}) const;

  /// The run as the page reads it: JSON, with numbers as base64 of little-endian Float32.
  std::string toJson() const;

 private:
  class Impl;
  std::unique_ptr<Impl> m_impl;
};

/// A list of recordings: `{a, b}`.
using Recordings = std::vector<std::reference_wrapper<const Recorder>>;

/// Writes a page with several runs: those of one scene side by side. Throws std::invalid_argument without a run,
/// and as Recorder::write does.
void writePageWith(const std::string& path, const Recordings& recordings,
                   const std::string& page_template, const std::string& known_template);

// CMake's target says where its template is; without CMake there is none but that of the environment.
#ifndef PINTLE_PAGE_TEMPLATE
#define PINTLE_PAGE_TEMPLATE ""
#endif

inline void writePage(const std::string& path, const Recordings& recordings,
                      const std::string& page_template = {}) {
  writePageWith(path, recordings, page_template, PINTLE_PAGE_TEMPLATE);
}

inline void Recorder::write(const std::string& path, const std::string& page_template) const {
  writePage(path, {*this}, page_template);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
