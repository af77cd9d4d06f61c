#include <pintle/record/json.h>
#include <pintle/record/recording.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace record {
namespace {

constexpr std::size_t max_written_contacts = 40;  // of a frame
constexpr float not_there = std::numeric_limits<float>::quiet_NaN();

// What is plotted over time: one number a frame.
struct Series {
  const char *key, *label, *unit;
  std::vector<float> values;
};

struct Energy {
  double linear = 0, angular = 0, potential = 0;
  btVector3 momentum = {0, 0, 0}, angular_momentum = {0, 0, 0};
};

void add(const Body& body, const State& state, Energy& to) {
  if (body.mass == 0) return;
  const btTransform pose = state.pose();
  const btVector3 v(state.velocity[0], state.velocity[1], state.velocity[2]);
  const btVector3 w(state.angular_velocity[0], state.angular_velocity[1],
                    state.angular_velocity[2]);
  const btVector3 own_w = pose.getBasis().transpose() * w;
  const btVector3 spin = pose.getBasis() * (body.inertia * own_w);
  to.linear += 0.5 * body.mass * double(v.length2());
  to.angular += 0.5 * double(w.dot(spin));
  to.potential -= body.mass * double(body.gravity.dot(pose.getOrigin()));
  to.momentum += btScalar(body.mass) * v;
  to.angular_momentum += btScalar(body.mass) * pose.getOrigin().cross(v) + spin;
}

double largest(double a, double b) { return a >= b ? a : b; }  // unlike std::max keeps a NaN

class Analysis {
 public:
  explicit Analysis(const Recording& recording) : m_recording(recording) {
    for (const Constraint& constraint : recording.constraints)
      m_meters.emplace_back(constraint.description);
    for (const Frame& frame : recording.frames) measure(frame);
    m_series[overshoot].unit = unitOfLimits();
  }

  std::string json() const {
    Json all('[');
    for (const Series& series : m_series) {
      // What is nothing all the time, or not known, is left out.
      const bool is_known =
          std::any_of(series.values.begin(), series.values.end(),
                      [](float value) { return std::isfinite(value) && value != 0; });
      if (!is_known && !(&series == &m_series[gap] && std::isfinite(series.values[0]))) continue;
      Json one('{');
      one.text("key", series.key).text("label", series.label).text("unit", series.unit);
      all.item(one.raw("values", base64(series.values)).str());
    }
    return all.str();
  }

 private:
  const char* unitOfLimits() const {
    bool lengths = false, angles = false;
    for (const Constraint& constraint : m_recording.constraints) {
      for (const Limit& limit : constraint.description.limits) {
        const bool is_length =
            limit.kind == Limit::Kind::slide || limit.kind == Limit::Kind::distance;
        (is_length ? lengths : angles) = true;
      }
    }
    return lengths && angles ? "rad or m" : lengths ? "m" : "rad";
  }

  // In this order.
  enum {
    gap,
    angle_off,
    overshoot,
    linear,
    angular,
    potential,
    total,
    momentum,
    spin,
    impulse,
    step
  };

  void measure(const Frame& frame) {
    const Recording& of = m_recording;
    Errors worst;
    float strongest = 0;
    for (std::size_t i = 0; i < of.constraints.size(); ++i) {
      const Constraint& constraint = of.constraints[i];
      if (!constraint.lifetime.contains(frame.number)) continue;
      btTransform a, b;
      if (!pose(constraint.a, frame, a) || !pose(constraint.b, frame, b)) continue;
      const Errors errors = m_meters[i](a, b);
      worst.gap = largest(worst.gap, errors.gap);
      worst.angle_off = largest(worst.angle_off, errors.angle_off);
      worst.overshoot = largest(worst.overshoot, errors.overshoot);
      if (int(i) < frame.impulses) strongest = std::max(strongest, frame.impulse[i]);
    }
    Energy energy;
    for (const Body& body : of.bodies) {
      if (const State* const state = of.state(body, frame)) add(body, *state, energy);
    }
    const bool joints = !of.constraints.empty();
    put(gap, joints ? worst.gap : not_there);
    put(angle_off, joints ? worst.angle_off : not_there);
    put(overshoot, joints ? worst.overshoot : not_there);
    put(linear, energy.linear);
    put(angular, energy.angular);
    put(potential, energy.potential);
    put(total, energy.linear + energy.angular + energy.potential);
    put(momentum, double(energy.momentum.length()));
    put(spin, double(energy.angular_momentum.length()));
    put(impulse, joints ? strongest : not_there);
    put(step, frame.step_seconds >= 0 ? 1e6 * frame.step_seconds : double(not_there));
  }

  bool pose(int body, const Frame& frame, btTransform& to) const {
    to.setIdentity();
    if (body < 0) return true;
    const State* const state = m_recording.state(m_recording.bodies[std::size_t(body)], frame);
    if (state != nullptr) to = state->pose();
    return state != nullptr;
  }
  void put(int series, double value) {
    m_series[std::size_t(series)].values.push_back(float(value));
  }

  const Recording& m_recording;
  std::vector<ErrorMeter> m_meters;
  std::vector<Series> m_series = {{"gap", "Gap", "m", {}},
                                  {"angleOff", "Angle off", "rad", {}},
                                  {"overshoot", "Overshoot", "rad or m", {}},
                                  {"linear", "Kinetic, linear", "J", {}},
                                  {"angular", "Kinetic, turning", "J", {}},
                                  {"potential", "Potential", "J", {}},
                                  {"total", "Energy", "J", {}},
                                  {"momentum", "Momentum", "N s", {}},
                                  {"spin", "Angular momentum", "N m s", {}},
                                  {"impulse", "Largest joint impulse", "N s", {}},
                                  {"step", "Time of a step", "us", {}}};
};

// Frames by their place, of those that are left.
std::string spans(const Lifetime& lifetime, const std::vector<Frame>& frames) {
  const auto place = [&](int number) {
    const auto at = std::lower_bound(frames.begin(), frames.end(), number,
                                     [](const Frame& f, int n) { return f.number < n; });
    return double(at - frames.begin());
  };
  Json all('[');
  for (const auto& span : lifetime.spans)
    all.item(Json('[').item(place(span.first)).item(place(span.second)).str());
  return all.str();
}

}  // namespace

std::string Recording::json() const {
  Json run('{');
  run.text("format", "pintle-run").number("version", 1);
  run.text("name", options.name).text("scene", options.scene);
  run.text("title", options.title.empty() ? options.scene : options.title);
  run.text("text", options.text).text("group", options.group).text("detail", options.detail);
  run.text("colour", options.colour).text("precision", sizeof(btScalar) == 8 ? "double" : "single");
  run.vector("gravity", gravity).number("stride", stride).number("frames", double(frames.size()));

  std::vector<float> times, contact_counts, contact_points;
  for (const Frame& frame : frames) {
    times.push_back(float(frame.time));
    // The strongest: a page is to stay small.
    std::vector<Contact> contacts = frame.contacts;
    if (contacts.size() > max_written_contacts) {
      std::nth_element(contacts.begin(), contacts.begin() + max_written_contacts, contacts.end(),
                       [](const Contact& a, const Contact& b) { return a.impulse > b.impulse; });
      contacts.resize(max_written_contacts);
    }
    contact_counts.push_back(float(contacts.size()));
    for (const Contact& contact : contacts) {
      contact_points.insert(contact_points.end(), contact.point, contact.point + 3);
      contact_points.push_back(contact.impulse);
    }
  }
  run.raw("times", base64(times));

  Json shape_list('[');
  for (const std::string& shape : shapes) shape_list.item(shape);
  run.raw("shapes", shape_list.str());

  Json body_list('[');
  std::vector<float> poses;
  int tracks = 0;
  for (const Body& body : bodies) {
    Json item('{');
    item.number("shape", body.shape).text("kind", body.kind).number("mass", body.mass);
    item.raw("alive", spans(body.lifetime, frames));
    if (body.slot < 0) {
      std::vector<float> pose;
      appendPose(body.initial.pose(), pose);
      Json still('[');
      for (const float value : pose) still.item(double(value));
      item.raw("pose", still.str());
    } else {
      item.number("track", tracks++);
      for (const Frame& frame : frames) {
        const State* const at = state(body, frame);
        if (at != nullptr) appendPose(at->pose(), poses);
        if (at == nullptr) poses.insert(poses.end(), 7, not_there);
      }
    }
    body_list.item(item.str());
  }
  run.raw("bodies", body_list.str()).raw("poses", base64(poses));

  Json joint_list('[');
  for (const Constraint& constraint : constraints) {
    std::string item = constraint.description.json(constraint.a, constraint.b);
    item.back() = ',';
    joint_list.item(item + "\"alive\":" + spans(constraint.lifetime, frames) + '}');
  }
  run.raw("joints", joint_list.str());
  run.raw(
      "contacts",
      Json('{').raw("counts", base64(contact_counts)).raw("points", base64(contact_points)).str());
  run.raw("series", Analysis(*this).json());

  Json figure_list('[');
  for (const Figure& figure : figures) {
    Json item('{');
    item.text("name", figure.name).text("unit", figure.unit).number("value", figure.value);
    figure_list.item(item.str());
  }
  return run.raw("figures", figure_list.str()).str();
}

}  // namespace record
}  // namespace PINTLE_PRECISION
}  // namespace pintle
