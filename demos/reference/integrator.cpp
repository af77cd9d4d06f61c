#include "integrator.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "springs.h"

namespace reference {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Quaterniond;
using Eigen::VectorXd;
using scenes::Joint;
using scenes::Scene;
using scenes::Vector3d;
class System {
 public:
  explicit System(const Scene& scene) : scene_(scene) {
    if (scene.contacts()) throw std::invalid_argument("reference: contacts are not solved");
    if (scene.has(scenes::Error::recovery))
      throw std::invalid_argument("reference: a joint that starts apart is not solved");
    for (const scenes::Body& body : scene.bodies) {
      if (body.damping != 0 || !body.torque.isZero())
        throw std::invalid_argument("reference: damping and lasting torques are not solved");
      bodies_.push_back({body.pose.translation(), Quaterniond(body.pose.linear()), body.velocity,
                         body.angular_velocity});
    }
    for (const Joint& joint : scene.joints) {
      const bool distance = joint.kind == scenes::Kind::distance,
                 strut = distance && joint.spring.frequency > 0;
      if (joint.range.limited() != strut || (distance && !strut) || joint.motor.speed)
        throw std::invalid_argument("reference: limits and motors are not solved");
      rows_ += row_count(joint.kind);
    }
  }

  void step(double h) {
    // Runge-Kutta on (x, q, v, w); q' = 1/2 w q, normalized at the end.
    const std::vector<Coordinates> start = bodies_;
    std::vector<Slope> sum(bodies_.size());
    std::vector<Slope> k;
    const double weight[] = {1. / 6, 1. / 3, 1. / 3, 1. / 6}, next[] = {0.5, 0.5, 1, 0};
    for (int stage = 0; stage < 4; ++stage) {
      k = slope();
      for (size_t i = 0; i < k.size(); ++i) {
        sum[i].add(k[i], weight[stage]);
        bodies_[i] = k[i].from(start[i], next[stage] * h);
      }
    }
    for (size_t i = 0; i < sum.size(); ++i) bodies_[i] = sum[i].from(start[i], h);
    project();
  }

  // One of Bullet's, with joints that hold at its end (make_bullet_steps).
  void bullet_step(double h) {
    evaluate();
    const std::vector<StiffSpring> stiff = add_stiff_springs(h);
    const Eigen::Index rows = rows_ + Eigen::Index(stiff.size());
    if (rows > 0) factorize();
    VectorXd force = VectorXd::Zero(6 * Eigen::Index(bodies_.size())),
             impulse = VectorXd::Zero(rows);
    add_springs(force, h);
    const std::vector<Coordinates> start = bodies_;
    VectorXd v(force.size());
    for (size_t i = 0; i < start.size(); ++i) {
      v.segment<3>(6 * Eigen::Index(i)) =
          start[i].v + h * (force.segment<3>(6 * Eigen::Index(i)) - Vector3d(0, 0, gravity_of(i)));
      v.segment<3>(6 * Eigen::Index(i) + 3) = i == 0 ? start[i].w : after_gyroscopic(i, h);
    }
    constexpr int max_iterations = 200;
    for (int iteration = 0; iteration < max_iterations; ++iteration) {
      for (size_t i = 1; i < start.size(); ++i) {
        Coordinates& body = bodies_[i];
        body.v = v.segment<3>(6 * Eigen::Index(i));
        body.w = v.segment<3>(6 * Eigen::Index(i) + 3);
        body.x = start[i].x + h * body.v;
        body.q = (bullet_turn(body.w, h) * start[i].q).normalized();
      }
      if (rows == 0) return;
      evaluate_values();
      value_.conservativeResize(rows);
      for (Eigen::Index i = rows_; i < rows; ++i) {
        const StiffSpring& spring = stiff[size_t(i - rows_)];
        value_[i] = spring.error(extension(*spring.joint).value, impulse[i]);
      }
      constexpr double rounding = 1e-12;
      if (value_.cwiseAbs().maxCoeff() < rounding) return;
      const VectorXd change = factor_.solve(value_ / h);
      impulse -= change;
      v -= W_ * change;
    }
  }
  engines::State state(int body) const {
    const Coordinates& at = bodies_[size_t(body)];
    engines::State state;
    state.pose = Eigen::Translation3d(at.x) * at.q;
    state.velocity = at.v;
    state.angular_velocity = at.w;
    return state;
  }

  double energy() const {
    double sum = 0;
    for (size_t i = 1; i < bodies_.size(); ++i) {
      const scenes::Body& body = scene_.bodies[i];
      const Vector3d w = bodies_[i].q.conjugate() * bodies_[i].w;
      sum += 0.5 * body.mass * bodies_[i].v.squaredNorm() + 0.5 * body.inertia.dot(w.cwiseAbs2()) +
             body.mass * scene_.gravity * bodies_[i].x.z();
    }
    return sum;
  }
  double violation() {
    evaluate();
    return rows_ == 0 ? 0 : value_.cwiseAbs().maxCoeff();
  }
  Vector3d probe() const {
    const Coordinates& body = bodies_[size_t(scene_.probe_body)];
    return body.x + body.q * scene_.probe;
  }

 private:
  struct Slope {
    Vector3d x = {0, 0, 0};
    Eigen::Vector4d q = {0, 0, 0, 0};
    Vector3d v = {0, 0, 0}, w = {0, 0, 0};
    void add(const Slope& other, double weight) {
      x += weight * other.x;
      q += weight * other.q;
      v += weight * other.v;
      w += weight * other.w;
    }
    Coordinates from(const Coordinates& start, double h) const {
      Coordinates to = start;
      to.x += h * x;
      to.q.coeffs() += h * q;
      to.q.normalize();
      to.v += h * v;
      to.w += h * w;
      return to;
    }
  };

  double gravity_of(size_t body) const { return body == 0 ? 0 : scene_.gravity; }

  // One step of Newton's method towards the implicit one (btRigidBody's default).
  Vector3d after_gyroscopic(size_t i, double h) const {
    const Matrix3d R = bodies_[i].q.toRotationMatrix();
    const Vector3d w = R.transpose() * bodies_[i].w, L = scene_.bodies[i].inertia.cwiseProduct(w);
    const Matrix3d I = scene_.bodies[i].inertia.asDiagonal();
    const Matrix3d slope = I + h * (skew(w) * I - skew(L));
    return R * (w - slope.inverse() * (h * w.cross(L)));
  }
  static Matrix3d skew(const Vector3d& u) {
    Matrix3d S;
    S << 0, -u.z(), u.y(), u.z(), 0, -u.x(), -u.y(), u.x(), 0;
    return S;
  }
  // btTransformUtil::integrateTransform: above pi/4 a step it turns by less than w says.
  static Quaterniond bullet_turn(const Vector3d& w, double h) {
    const double speed = std::min(w.norm(), scenes::pi / 4 / h);
    if (speed == 0) return Quaterniond::Identity();
    const Vector3d axis = w * (std::sin(speed * h / 2) / speed);
    return {std::cos(speed * h / 2), axis.x(), axis.y(), axis.z()};
  }

  Matrix3d inverse_inertia(size_t i) const {
    const Matrix3d R = bodies_[i].q.toRotationMatrix();
    return R * scene_.bodies[i].inertia.cwiseInverse().asDiagonal() * R.transpose();
  }

  // value_ = C, gradient_ = J by body and column, curvature_ = C'' at constant velocities.
  void evaluate() {
    const int columns = 6 * int(bodies_.size());
    value_.setZero(rows_);
    curvature_.setZero(rows_);
    gradient_.setZero(rows_, columns);
    Taylor C[6];
    int row = 0;
    for (const Joint& joint : scene_.joints) {
      const Coordinates &a = bodies_[size_t(joint.a)], &b = bodies_[size_t(joint.b)];
      const int count = row_count(joint.kind);
      constraints(joint.kind, Frame(a, joint.in_a, a.v, a.w), Frame(b, joint.in_b, b.v, b.w), C);
      for (int i = 0; i < count; ++i) {
        value_[row + i] = C[i].value;
        curvature_[row + i] = C[i].second;
      }
      for (int of_b = 0; of_b < 2; ++of_b) {
        const int body = of_b ? joint.b : joint.a;
        if (body == 0) continue;
        for (int column = 0; column < 6; ++column) {
          const Vector3d unit = Vector3d::Unit(column % 3), zero(0, 0, 0);
          const Vector3d v = column < 3 ? unit : zero, w = column < 3 ? zero : unit;
          constraints(joint.kind, Frame(a, joint.in_a, of_b ? zero : v, of_b ? zero : w),
                      Frame(b, joint.in_b, of_b ? v : zero, of_b ? w : zero), C);
          for (int i = 0; i < count; ++i) gradient_(row + i, 6 * body + column) = C[i].first;
        }
      }
      row += count;
    }
  }

  void evaluate_values() {
    const Vector3d zero(0, 0, 0);
    Taylor C[6];
    int row = 0;
    for (const Joint& joint : scene_.joints) {
      constraints(joint.kind, Frame(bodies_[size_t(joint.a)], joint.in_a, zero, zero),
                  Frame(bodies_[size_t(joint.b)], joint.in_b, zero, zero), C);
      for (int i = 0; i < row_count(joint.kind); ++i) value_[row++] = C[i].value;
    }
  }

  Extension extension(const Joint& joint) const {
    return {joint, bodies_[size_t(joint.a)], bodies_[size_t(joint.b)]};
  }

  // Stiff springs are rows with a softness, the last ones of gradient_.
  std::vector<StiffSpring> add_stiff_springs(double h) {
    std::vector<StiffSpring> stiff;
    softness_.setZero(rows_);
    for (const Joint& joint : scene_.joints) {
      if (joint.spring.frequency == 0 || !is_stiff(joint.spring, h)) continue;
      const Extension now = extension(joint);
      stiff.emplace_back(scene_, joint, now, h);
      const Eigen::Index row = softness_.size();
      softness_.conservativeResize(row + 1);
      softness_[row] = stiff.back().softness / h;
      gradient_.conservativeResize(row + 1, Eigen::NoChange);
      gradient_.row(row).setZero();
      const auto set = [&](int body, const Vector3d& arm, const Vector3d& axis) {
        if (body == 0) return;
        gradient_.row(row).segment<3>(6 * body) = axis;
        gradient_.row(row).segment<3>(6 * body + 3) = arm.cross(axis);
      };
      set(joint.a, now.arm_a, -now.axis);
      set(joint.b, now.arm_b, now.axis);
    }
    return stiff;
  }

  // W = M^-1 J^T, and J W factorized.
  void factorize() {
    W_ = gradient_.transpose();
    for (size_t i = 1; i < bodies_.size(); ++i) {
      W_.middleRows(6 * Eigen::Index(i), 3) /= scene_.bodies[i].mass;
      W_.middleRows(6 * Eigen::Index(i) + 3, 3) =
          inverse_inertia(i) * W_.middleRows(6 * Eigen::Index(i) + 3, 3).eval();
    }
    MatrixXd K = gradient_ * W_;
    if (softness_.size() > 0) K.diagonal() += softness_;
    factor_.compute(K);
    // Redundant constraints leave pivots of nothing but rounding. Which of them carries the load
    // means nothing: a little compliance decides.
    const VectorXd pivots = factor_.vectorD().cwiseAbs();
    if (pivots.minCoeff() > 1e-10 * pivots.maxCoeff()) return;
    K.diagonal().array() += 1e-12 * pivots.maxCoeff();
    factor_.compute(K);
  }

  std::vector<Slope> slope() {
    VectorXd a = VectorXd::Zero(6 * Eigen::Index(bodies_.size()));
    for (size_t i = 1; i < bodies_.size(); ++i) {
      const Matrix3d R = bodies_[i].q.toRotationMatrix();
      const Vector3d w = R.transpose() * bodies_[i].w, I = scene_.bodies[i].inertia;
      a.segment<3>(6 * Eigen::Index(i)) = Vector3d(0, 0, -scene_.gravity);
      a.segment<3>(6 * Eigen::Index(i) + 3) =
          R * I.cwiseInverse().cwiseProduct(I.cwiseProduct(w).cross(w));
    }
    add_springs(a);
    if (rows_ > 0) {
      evaluate();
      factorize();
      a -= W_ * factor_.solve(gradient_ * a + curvature_);
    }
    std::vector<Slope> k(bodies_.size());
    for (size_t i = 1; i < bodies_.size(); ++i) {
      k[i].x = bodies_[i].v;
      Quaterniond w(0, bodies_[i].w.x(), bodies_[i].w.y(), bodies_[i].w.z());
      k[i].q = 0.5 * (w * bodies_[i].q).coeffs();
      k[i].v = a.segment<3>(6 * Eigen::Index(i));
      k[i].w = a.segment<3>(6 * Eigen::Index(i) + 3);
    }
    return k;
  }

  // Accelerations by springs, but by those that are stiff for steps of h.
  void add_springs(VectorXd& a, double h = 0) const {
    for (const Joint& joint : scene_.joints) {
      if (joint.spring.frequency == 0 || is_stiff(joint.spring, h)) continue;
      const Extension now = extension(joint);
      const SpringConstants spring(scene_, joint);
      const Vector3d force =
          -(spring.stiffness * now.value + spring.damping * now.speed) * now.axis;
      const auto push = [&](int body, const Vector3d& arm, const Vector3d& by) {
        if (body == 0) return;
        a.segment<3>(6 * body) += by / scene_.bodies[size_t(body)].mass;
        a.segment<3>(6 * body + 3) += inverse_inertia(size_t(body)) * arm.cross(by);
      };
      push(joint.a, now.arm_a, -force);
      push(joint.b, now.arm_b, force);
    }
  }

  // Newton's method on the positions, then the velocities.
  void project() {
    if (rows_ == 0) return;
    evaluate();
    factorize();
    const VectorXd shift = -W_ * factor_.solve(value_);
    for (size_t i = 1; i < bodies_.size(); ++i) {
      bodies_[i].x += shift.segment<3>(6 * Eigen::Index(i));
      const Vector3d turn = shift.segment<3>(6 * Eigen::Index(i) + 3);
      const Quaterniond half(1, turn.x() / 2, turn.y() / 2, turn.z() / 2);
      bodies_[i].q = (half * bodies_[i].q).normalized();
    }
    VectorXd v(6 * Eigen::Index(bodies_.size()));
    for (size_t i = 0; i < bodies_.size(); ++i) {
      v.segment<3>(6 * Eigen::Index(i)) = bodies_[i].v;
      v.segment<3>(6 * Eigen::Index(i) + 3) = bodies_[i].w;
    }
    v -= W_ * factor_.solve(gradient_ * v);
    for (size_t i = 1; i < bodies_.size(); ++i) {
      bodies_[i].v = v.segment<3>(6 * Eigen::Index(i));
      bodies_[i].w = v.segment<3>(6 * Eigen::Index(i) + 3);
    }
  }

  const Scene& scene_;
  std::vector<Coordinates> bodies_;
  int rows_ = 0;
  VectorXd value_, curvature_, softness_;
  MatrixXd gradient_, W_;
  Eigen::LDLT<MatrixXd> factor_;
};

class BulletSteps : public engines::Engine {
 public:
  explicit BulletSteps(const Scene& scene) : scene_(scene), system_(scene_) {}
  void drive(double, double) override {}
  void step(double dt) override { system_.bullet_step(dt); }
  engines::State state(int body) const override { return system_.state(body); }

 private:
  Scene scene_;
  System system_;
};

}  // namespace

std::unique_ptr<engines::Engine> make_bullet_steps(const Scene& scene) {
  return std::make_unique<BulletSteps>(scene);
}

Solution solve(const Scene& scene, double dt, double interval) {
  System system(scene);
  Solution solution;
  const double start = system.energy();
  const int samples = int(std::lround(scene.horizon / interval));
  const int steps = int(std::ceil(interval / dt - 1e-9));
  for (int sample = 0; sample < samples; ++sample) {
    for (int step = 0; step < steps; ++step) {
      system.step(interval / steps);
      solution.energy_change = std::max(solution.energy_change, std::abs(system.energy() - start));
    }
    solution.gap = std::max(solution.gap, system.violation());
    solution.probe.push_back(system.probe());
  }
  return solution;
}

}  // namespace reference
