// A scene as data: bodies, joints by kind, what drives them, for how long, and what is measured.
//
// It names no engine and no joint class: engines/ builds it with each contender's own, measures/
// takes its errors from the bodies' poses alone, and reference/ solves it by another method. SI
// units, z up. Body 0 is the ground, which never moves.

#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "angles.h"

namespace scenes {

using Eigen::Isometry3d;
using Eigen::Vector3d;

enum class Form {
  box,
  sphere,   // of radius half_extents.x
  capsule,  // along z: of radius half_extents.x, its caps' centres half_extents.z from its own
  cylinder  // along z
};

struct Body {
  double mass = 0;                        // kg; 0: does not move
  Vector3d half_extents = {1, 1, 1};      // m, of the box that it is, or as its form has it
  Vector3d inertia = {0, 0, 0};           // kg m^2, about its axes
  Isometry3d pose;                        // of its centre of mass
  Vector3d velocity = {0, 0, 0};          // m/s
  Vector3d angular_velocity = {0, 0, 0};  // rad/s, world
  Vector3d torque = {0, 0, 0};            // N m, world: acts all the time
  double damping = 0;                     // the part of its speeds that Bullet takes away a second
  bool collides = false;
  double friction = 0.5;
  Form form = Form::box;
};

// What a joint's own frames mean is Bullet's convention for its kind.
enum class Kind {
  ball,
  hinge,              // turns about z
  slider,             // slides along x
  fixed,              // nothing
  cone_twist,         // twists about x, and swings; b is the limb
  universal,          // turns about z of a and y of b
  constant_velocity,  // shafts along x
  wedge,              // x of b between two half planes about z of a
  angle,              // turns about z within its range; nothing else is held
  distance,           // origins as far apart as its range says
  contact,            // origin of b not below the plane z = 0 of a
  gear                // as a turns about its z, b turns the other way about its own
};

// Of a joint's free coordinate: an angle of b against a (rad; of a universal joint about y of b), the bend of a
// constant velocity joint (from 0), the slider's position or a distance (m).
struct Range {
  double low = 1, high = -1;  // low > high: free
  bool limited() const { return low <= high; }
};

// Of a cone-twist joint, rad.
struct Spans {
  double about_z, about_y, twist;
};

// Holds a slider at its position 0, or a distance at its range's one length, as the two bodies would swing if
// they could not turn; gives a hinge's limits, beyond which the bodies swing so about its axis.
struct Spring {
  double frequency = 0;  // Hz; 0: none
  double damping_ratio = 0;
};

// Turns b against a about a hinge's axis, or moves it along a slider's.
struct Motor {
  std::function<double(double time)> speed;  // rad/s, of a slider m/s; empty: none
  double max_torque = 0;                     // N m, of a slider N
};

// Turns b against a about a cone-twist joint to a pose. Bullet's own motor has no stiffness: it goes to the pose as fast as its bound lets it.
struct Muscle {
  Eigen::Quaterniond pose =
      Eigen::Quaterniond::Identity();  // of the joint's frame of b in that of a
  double stiffness = 0;                // N m/rad; 0: there is none
  double damping = 0;                  // N m s/rad
  double max_torque = 0;               // N m
};

struct Joint {
  Kind kind;
  int a, b;               // bodies, a the one nearer to the ground
  Isometry3d in_a, in_b;  // the joint's frames in theirs
  Range range = {};
  Spans spans = {pi, pi, pi};
  Spring spring = {};
  Motor motor = {};
  Muscle muscle = {};
  double restitution = 0;  // of a contact, or of a slider's limits
  double ratio = 1;        // of a gear: turns of a for one of b
  double breaks_at = 0;    // N s in a step, beyond which it breaks; 0: never
};

enum class Error {
  gap,   // m: between what a joint holds together; the mean over time of the worst joint
  axis,  // rad: between axes or orientations that a joint holds together, or a muscle; likewise
  overshoot,   // rad, or m where the limit is one of a distance: the farthest beyond it
  energy,      // of the scene's energy_scale: the largest change
  gained,      // the same, only upwards: where limits and contacts may take energy away
  momentum,    // the largest change of the angular momentum about the origin, relative
  trajectory,  // m: the mean distance of a point from where it should be
  recovery,    // s: after which axis errors from the start stay within a degree; infinity: never
  count
};
const char* name(Error error);
const char* unit(Error error);

// Where the page shows a scene.
enum class Group { known, wrong, limits, measured };
const char* name(Group group);

// With what the report compares its contenders: all iterations and steps, or those of a game alone, as of
// machines, which are long. Nowhere where Bullet has no joint for it, or where its error is not one that more work would lessen.
enum class Compared { over_all_settings, as_games_run, nowhere };

// A bug of stock's joints that Pintle's do not have: of a run in steps of 1/60 s and 10 iterations.
struct Mended {
  Error error = Error::count;  // count: there is none here
  double stock_at_least = 0, pintle_at_most = 0;
  bool by_solver = false;  // it takes the exact solver: on Bullet's, Pintle's err as stock's do
};

struct Scene {
  std::string name, title;
  std::vector<Body> bodies = {ground()};
  std::vector<Joint> joints = {};
  double gravity = standard_gravity;
  double seconds = 5;
  std::vector<Error> errors = {Error::gap};  // the first one is what matters most here
  double energy_scale = 1;                   // J
  Compared compared = Compared::over_all_settings;
  // Of a published collection: the report has its errors against the reference, whether Bullet has joints for it or not.
  std::string problem = {};
  // Whether a page of all scenes has it, or only one that is asked for: with a hundred bodies it takes much room.
  bool in_gallery = true;
  // Whose trajectory: a point of a body (m, in its frame), over this time. Where it should be is a
  // closed form, or else the stored solution of reference/.
  int probe_body = 0;
  Vector3d probe = {0, 0, 0};
  double horizon = 0;  // s
  std::function<Vector3d(double time)> closed_form = {};
  // Words for who has never seen it: a headline, what happens, and what to look at. Empty: name and title.
  Group group = Group::measured;
  std::string headline = {}, text = {};
  Mended mended = {};

  bool contacts() const;
  // Whether any impulse has a bound: of limits, motors or contacts.
  bool bounded() const;
  bool has(Error error) const;
  void show(Group in_group, const std::string& with_headline, const std::string& with_text);
  // Indices, by which joints name them.
  int add(const Body& body);
  // The joint's frames coincide at the start, in this frame of the world.
  Joint& connect(Kind kind, int a, int b, const Isometry3d& frame);
  // Another scene's bodies and joints, moved. Its ground is this one's.
  void append(const Scene& part, const Isometry3d& pose);

  static Body ground();
};

// A homogeneous one, upright at a point unless turned.
Body box(double mass, const Vector3d& half_extents, const Vector3d& position,
         const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity());

// The same of other forms; along z unless turned.
Body sphere(double mass, double radius, const Vector3d& position);
Body cylinder(double mass, double radius, double half_height, const Vector3d& position,
              const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity());
Body capsule(double mass, double radius, double half_height, const Vector3d& position,
             const Eigen::Quaterniond& turn = Eigen::Quaterniond::Identity());
// A box in the form of a cylinder along z, which it moves as if it were still a box: for a wheel that collides with nothing.
Body round(Body body, double radius);
// One that collides.
Body solid(Body body);

// Lets a body turn about a point of the world, which stays where it is.
void spin(Body& body, const Vector3d& angular_velocity, const Vector3d& about);

// The shortest turn that takes one direction to another. (Compiled once: it brings in a decomposition.)
Eigen::Quaterniond turn_between(const Vector3d& from, const Vector3d& to);

// Frames of the world at a point.
Isometry3d at(const Vector3d& point);
Isometry3d with_z(const Vector3d& point, const Vector3d& z);
Isometry3d with_x(const Vector3d& point, const Vector3d& x);

}  // namespace scenes
