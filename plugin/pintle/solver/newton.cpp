#include <pintle/solver/newton.h>

#include <pintle/body_pair.h>
#include <pintle/joints/joint.h>
#include <pintle/solver/active_set.h>
#include <pintle/solver/discrete_gradient.h>
#include <pintle/solver/geometric_derivative.h>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

const BodyAtEnd resting{Vector6d::Zero(), Turn(), btTransform::getIdentity()};

const BodyAtEnd& bodyOf(const IslandJoint& joint, int side, const Component& component,
                        const Iterate& at) {
  const int body = joint.body[size_t(side)];
  return body < 0 ? resting : at.bodies[size_t(body - component.first_body)];
}

const btTransform& poseOf(const IslandJoint& joint, int side, const BodyAtEnd& end) {
  if (joint.body[size_t(side)] >= 0) return end.pose;
  return side ? joint.constraint->getRigidBodyB().getCenterOfMassTransform()
              : joint.constraint->getRigidBodyA().getCenterOfMassTransform();
}

void moveBody(const IslandBody& body, double dt, BodyAtEnd& end) {
  end.turn = Turn(end.v.tail<3>(), dt);
  const Matrix3d R = end.turn.rotation();
  const btMatrix3x3 turned(Scalar(R(0, 0)), Scalar(R(0, 1)), Scalar(R(0, 2)), Scalar(R(1, 0)),
                           Scalar(R(1, 1)), Scalar(R(1, 2)), Scalar(R(2, 0)), Scalar(R(2, 1)),
                           Scalar(R(2, 2)));
  end.pose.setBasis(turned * body.start.getBasis());
  const Vector3d x = dt * end.v.head<3>();
  end.pose.setOrigin(body.start.getOrigin() + btVector3(Scalar(x[0]), Scalar(x[1]), Scalar(x[2])));
}

// A row of the start, as a velocity.
void holdVelocity(const IslandRow& row, const BodyAtEnd& a, const BodyAtEnd& b, RowAtEnd& to) {
  to.J = to.G = row.J;
  to.u = row.J.along(a.v, b.v);
}

// From a row of poses to one of velocities: bodies turn as they do (Turn).
RowJacobian byVelocity(const Row& row, double sign, const BodyAtEnd& a, const BodyAtEnd& b) {
  const Vector3d L = sign * row.L.cast<double>();
  return {-L, -sign * (a.turn.slope.transpose() * row.A_a.cast<double>()), L,
          sign * (b.turn.slope.transpose() * row.A_b.cast<double>())};
}
RowJacobian byVelocity(const Gradient& G, double sign, const BodyAtEnd& a, const BodyAtEnd& b) {
  return {-sign * G.L, -sign * a.turn.part * G.A_a, sign * G.L, sign * b.turn.part * G.A_b};
}

// What the row of the start measures, among the rows of the end. Returns false if nothing does. Tangents of a joint may be chosen
// anew at each pose: an equality is then taken along that of the start.
bool findAtEnd(const IslandRow& row, const Rows& end, int equalities_at_start, Row& found) {
  if (row.start.axis >= 0) {
    for (int i = end.equalities(); i < end.size(); ++i)
      if (end[i].axis == row.start.axis) {
        found = end[i];
        return isSameRow(row.start, found);
      }
    return false;
  }
  if (end.equalities() != equalities_at_start) return false;
  found = end[row.index];
  if (isSameRow(row.start, found)) return true;
  found.L = found.A_a = found.A_b = Vec3::Zero();
  found.position = 0;
  bool any = false;
  for (int i = 0; i < end.equalities(); ++i) {
    const Row& other = end[i];
    if (other.angular != row.start.angular || other.group != row.start.group) continue;
    const Vec3 &mine = row.start.angular ? row.start.A_b : row.start.L,
               &its = row.start.angular ? other.A_b : other.L;
    const Scalar part = mine.dot(its) / its.dot(its);
    found.L += part * other.L;
    found.A_a += part * other.A_a;
    found.A_b += part * other.A_b;
    found.position += part * other.position;
    any = any || btFabs(part) > Scalar(0.1);
  }
  return any;
}

// Where an arm of a body points when the step ends, and its mean.
struct Arm {
  Vector3d end, mean;

  Arm(const BodyAtEnd& body, const Vec3& start) : mean(body.turn.mean * inDouble(start)) {
    end = inDouble(start) + cross(body.turn.phi, mean);
  }
};

// Rows that are made of arms of the bodies, in closed form, without asking the joint.
void moveArms(const IslandRow& row, Tier tier, double horizon, const BodyAtEnd& a,
              const BodyAtEnd& b, RowAtEnd& to) {
  const Arm arm_a(a, row.shape.a), arm_b(b, row.shape.b);
  const auto turnsBy = [&](const Vector3d& A_a, const Vector3d& A_b) {
    to.J.A_a = a.turn.slope.transpose() * A_a;
    to.J.A_b = b.turn.slope.transpose() * A_b;
  };
  const auto actsAlong = [&](const Vector3d& L, const Vector3d& A_a, const Vector3d& A_b) {
    to.G = {-L, a.turn.part * A_a, L, b.turn.part * A_b};
  };
  if (row.shape.kind == RowShape::dot) {
    const Vector3d a_0 = inDouble(row.shape.a), b_0 = inDouble(row.shape.b);
    to.J.L_a = to.J.L_b = Vector3d::Zero();
    turnsBy(cross(arm_a.end, arm_b.end), cross(arm_b.end, arm_a.end));
    actsAlong(Vector3d::Zero(), cross(arm_a.mean, Vector3d((b_0 + arm_b.end) / 2)),
              cross(arm_b.mean, Vector3d((a_0 + arm_a.end) / 2)));
    to.u = to.G.along(a.v, b.v);
  } else {
    const Vector3d n_0 = inDouble(row.start.L);
    const Vector3d move = horizon * (b.v - a.v).head<3>() + cross(b.turn.phi, arm_b.mean) -
                          cross(a.turn.phi, arm_a.mean);
    Vector3d n_1 = n_0, n = n_0;
    if (row.shape.kind == RowShape::distance) {
      const Vector3d d_0 = double(row.shape.length) * n_0, d_1 = d_0 + move;
      const double length = d_1.norm(), sum = d_0.norm() + length;
      if (length > 0) n_1 = d_1 / length;
      if (sum > 0) n = (d_0 + d_1) / sum;
    }
    to.J.L_a = -n_1;
    to.J.L_b = n_1;
    turnsBy(-cross(arm_a.end, n_1), cross(arm_b.end, n_1));
    actsAlong(n, -cross(arm_a.mean, n), cross(arm_b.mean, n));
    to.u = n.dot(move) / horizon;
  }
  if (tier == Tier::start) to.G = row.J;
}

void moveRows(const Island& island, const IslandJoint& joint, const Component& component, Tier tier,
              Iterate& at, int first) {
  const BodyAtEnd &a = bodyOf(joint, 0, component, at), &b = bodyOf(joint, 1, component, at);
  RowMemory<max_joint_rows, max_joint_rows> memory;
  Rows end(memory);
  bool asked = false;
  for (int i = 0; i < joint.rows; ++i) {
    const IslandRow& row = island.rows[size_t(joint.first_row + i)];
    RowAtEnd& to = at.rows[size_t(first + i)];
    if (!row.has_position || !(at.horizon > 0)) {
      holdVelocity(row, a, b, to);
      continue;
    }
    if (row.isOfArms()) {
      moveArms(row, tier, at.horizon, a, b, to);
      continue;
    }
    if (!asked) joint.ours->addRows(PosePair(poseOf(joint, 0, a), poseOf(joint, 1, b)), end);
    asked = true;
    Row now;
    if (!findAtEnd(row, end, joint.equalities, now)) {
      holdVelocity(row, a, b, to);
      continue;
    }
    const double change = double(now.position) - double(row.start.position);
    to.J = byVelocity(now, row.sign, a, b);
    to.u = change / at.horizon;
    if (tier == Tier::start) {
      to.G = row.J;
      continue;
    }
    const Displacement by_a{at.horizon * a.v.head<3>(), a.turn.phi},
        by_b{at.horizon * b.v.head<3>(), b.turn.phi};
    const RowOfStep of{row.start, now, row.shape, row.shape};
    to.G = byVelocity(discreteGradient(of, row.sign * change, by_a, by_b), row.sign, a, b);
  }
}

// Steps of Newton are halved down to the least part. Short ones show a tangent that is of no use: the other one is tried.
constexpr double short_step = 0.1, min_part = 1e-3;

// Sizes of a correction: of the velocities, in the metric of the masses.
double velocityNorm(const Fronts& fronts, const std::vector<double>& x) {
  double sum = 0;
  for (int i = 0; i < fronts.bodies(); ++i)
    for (int k = 0; k < 6; ++k)
      sum += x[size_t(fronts.body(i) + k)] * x[size_t(fronts.body(i) + k)];
  return std::sqrt(sum);
}

class Solve {
 public:
  Solve(const Island& island, const Component& component, Tier tier, const SolverOptions& options,
        Fronts& fronts, Workspace& work)
      : m_island(island),
        m_component(component),
        m_tier(tier),
        m_options(options),
        m_fronts(fronts),
        m_work(work) {
    m_first.resize(size_t(m_component.joints));
    for (int c = 0; c < m_component.joints; ++c) {
      m_first[size_t(c)] = int(m_rows.size());
      for (int i = 0; i < joint(c).rows; ++i)
        m_rows.push_back(&m_island.rows[size_t(joint(c).first_row + i)]);
    }
    m_work.pieces.resize(m_rows.size());
  }

  NewtonReport run();
  bool factoriseMotion(const std::vector<char>& acts);

 private:
  const IslandBody& body(int i) const {
    return m_island.bodies[size_t(m_component.first_body + i)];
  }
  const IslandJoint& joint(int c) const {
    return m_island.joints[size_t(m_component.first_joint + c)];
  }

  void choosePieces(const Iterate& at, std::vector<LawPiece>& pieces) const {
    for (size_t i = 0; i < pieces.size(); ++i) {
      const IslandRow& row = *m_rows[i];
      pieces[i] = row.law.meet(at.rows[i].u - row.K * at.lambda[i], row.K);
    }
  }
  void findResidual(const Iterate& at, std::vector<double>& x);
  void assemble(const Iterate& at);
  void step(const std::vector<double>& x, double part);
  bool isConverged(const Iterate& at);
  void findBoundedCorrection(std::vector<double>& x);
  void keepBounded(const Iterate& at);
  double along(const RowJacobian& J, int joint, const std::vector<double>& x) const;

  const Island& m_island;
  const Component& m_component;
  const Tier m_tier;
  const SolverOptions& m_options;
  Fronts& m_fronts;
  Workspace& m_work;
  std::vector<const IslandRow*> m_rows;
  std::vector<int> m_first;  ///< of each joint's rows
  double m_momentum2 = 0, m_scale2 = 0, m_error = 0;
  bool m_exact = true;
  bool m_bounded = false;  ///< the active set is found by projected Gauss-Seidel
};

// x = -F, scaled, with the present pieces.
void Solve::findResidual(const Iterate& at, std::vector<double>& x) {
  x.assign(size_t(m_fronts.size()), 0.);
  m_momentum2 = m_error = 0;
  for (int i = 0; i < m_component.bodies; ++i) {
    const IslandBody& of = body(i);
    const Vector6d change = at.bodies[size_t(i)].v - of.v_free;
    double* const to = &x[size_t(m_fronts.body(i))];
    Eigen::Map<Vector3d> linear(to), angular(to + 3);
    linear = -of.mass * change.head<3>();
    angular = -of.inertia * change.tail<3>();
    if (m_tier == Tier::start)
      angular -= m_work.stiffness[size_t(i)] * (at.bodies[size_t(i)].v - of.v0).tail<3>();
  }
  for (int c = 0; c < m_component.joints; ++c) {
    const IslandJoint& of = joint(c);
    for (int i = 0; i < of.rows; ++i) {
      const auto r = size_t(m_first[size_t(c)] + i);
      const RowAtEnd& row = at.rows[r];
      const double lambda = at.lambda[r];
      for (int side = 0; side < 2; ++side) {
        if (of.body[size_t(side)] < 0) continue;
        double* const to =
            &x[size_t(m_fronts.body(of.body[size_t(side)] - m_component.first_body))];
        Eigen::Map<Vector3d> linear(to), angular(to + 3);
        linear += lambda * (side ? row.G.L_b : row.G.L_a);
        angular += lambda * (side ? row.G.A_b : row.G.A_a);
      }
      const LawPiece& piece = m_work.pieces[r];
      const double K = m_rows[r]->K, root = std::sqrt(K);
      const double left = piece.acts ? row.u + piece.softness * lambda - piece.target
                                     : K * (lambda - piece.impulse);
      x[size_t(m_fronts.joint(c) + i)] = -left / root;
      if (piece.acts) m_error = std::max(m_error, std::abs(left) * m_island.dt);
    }
  }
  for (int i = 0; i < m_component.bodies; ++i) {
    const IslandBody& of = body(i);
    double* const to = &x[size_t(m_fronts.body(i))];
    for (int k = 0; k < 6; ++k) {
      to[k] = of.locked[size_t(k)] ? 0 : to[k] / of.scale[k / 3];
      m_momentum2 += to[k] * to[k];
    }
  }
}

// [H -G^T; J softness], scaled: bodies by the roots of their masses, rows by that of K.
void Solve::assemble(const Iterate& at) {
  m_fronts.clear();
  const double dt = at.horizon;
  for (int i = 0; i < m_component.bodies; ++i) {
    const IslandBody& of = body(i);
    const Fronts::Block to = m_fronts.bodyBlock(i);
    Matrix3d inertia = of.inertia;
    if (m_tier == Tier::start) inertia += m_work.stiffness[size_t(i)];
    for (int k = 0; k < 3; ++k) {
      to.at[k * to.stride + k] += 1;
      for (int j = 0; j < 3; ++j)
        to.at[(3 + k) * to.stride + 3 + j] += inertia(k, j) / (of.scale[1] * of.scale[1]);
    }
  }
  for (int c = 0; c < m_component.joints; ++c) {
    const IslandJoint& of = joint(c);
    const Fronts::Block own = m_fronts.jointBlock(c);
    for (int i = 0; i < of.rows; ++i) {
      const auto r = size_t(m_first[size_t(c)] + i);
      const LawPiece& piece = m_work.pieces[r];
      double& diagonal = own.at[i * own.stride + i];
      if (!piece.acts)
        diagonal = 1;
      else
        diagonal = std::max(piece.softness / m_rows[r]->K,
                            m_fronts.couplesBodies(c) ? 0 : m_options.dependent_softness);
    }
    for (int side = 0; side < 2; ++side) {
      if (of.body[size_t(side)] < 0) continue;
      const IslandBody& with = m_island.bodies[size_t(of.body[size_t(side)])];
      const Fronts::Block J = m_fronts.jointBodyBlock(c, side),
                          G = m_fronts.bodyJointBlock(c, side);
      for (int i = 0; i < of.rows; ++i) {
        const auto r = size_t(m_first[size_t(c)] + i);
        const RowAtEnd& row = at.rows[r];
        const double root = std::sqrt(m_rows[r]->K);
        const bool acts = m_work.pieces[r].acts;
        for (int k = 0; k < 6; ++k) {
          if (with.locked[size_t(k)]) continue;
          const double scale = 1 / (root * with.scale[k / 3]);
          const Vector3d &along = k < 3 ? (side ? row.J.L_b : row.J.L_a)
                                        : (side ? row.J.A_b : row.J.A_a),
                         &by = k < 3 ? (side ? row.G.L_b : row.G.L_a)
                                     : (side ? row.G.A_b : row.G.A_a);
          if (acts) J.at[i * J.stride + k] += scale * along[k % 3];
          // The impulse of a row is root(K) times its unknown... scaled likewise.
          G.at[k * G.stride + i] -= scale * by[k % 3];
        }
      }
    }
    if (m_tier != Tier::gradient) continue;
    GeometricDerivative H;
    const BodyAtEnd &a = bodyOf(of, 0, m_component, at), &b = bodyOf(of, 1, m_component, at);
    for (int i = 0; i < of.rows; ++i) {
      const auto r = size_t(m_first[size_t(c)] + i);
      H.add(*m_rows[r], at.rows[r], at.lambda[r], a, b, dt);
    }
    if (!m_exact) H.clip();
    for (int side = 0; side < 2; ++side) {
      if (of.body[size_t(side)] < 0) continue;
      const IslandBody& mine = m_island.bodies[size_t(of.body[size_t(side)])];
      const auto add = [&](const Fronts::Block& to, const IslandBody& by, int column) {
        for (int k = 0; k < 6; ++k)
          for (int j = 0; j < 6; ++j)
            if (!mine.locked[size_t(k)] && !by.locked[size_t(j)])
              to.at[k * to.stride + j] +=
                  H.matrix()(6 * side + k, 6 * column + j) / (mine.scale[k / 3] * by.scale[j / 3]);
      };
      add(m_fronts.bodyBlock(of.body[size_t(side)] - m_component.first_body), mine, side);
      if (of.body[size_t(1 - side)] >= 0 && m_fronts.couplesBodies(c))
        add(m_fronts.bodyBodyBlock(c, side), m_island.bodies[size_t(of.body[size_t(1 - side)])],
            1 - side);
    }
  }
  // What its factors hold does not change.
  for (int i = 0; i < m_component.bodies; ++i) {
    const IslandBody& of = body(i);
    const Fronts::Block to = m_fronts.bodyBlock(i);
    for (int k = 3; k < 6; ++k)
      if (of.locked[size_t(k)])
        for (int j = 3; j < 6; ++j) {
          to.at[k * to.stride + j] = k == j;
          to.at[j * to.stride + k] = k == j;
        }
  }
}

// next = now + part x
void Solve::step(const std::vector<double>& x, double part) {
  const Iterate& from = m_work.now;
  Iterate& to = m_work.next;
  for (int i = 0; i < m_component.bodies; ++i) {
    const IslandBody& of = body(i);
    const double* const d = &x[size_t(m_fronts.body(i))];
    Vector6d& v = to.bodies[size_t(i)].v;
    v = from.bodies[size_t(i)].v;
    for (int k = 0; k < 6; ++k)
      if (!of.locked[size_t(k)]) v[k] += part * d[k] / of.scale[k / 3];
  }
  for (int c = 0; c < m_component.joints; ++c)
    for (int i = 0; i < joint(c).rows; ++i) {
      const auto r = size_t(m_first[size_t(c)] + i);
      to.lambda[r] =
          from.lambda[r] + part * x[size_t(m_fronts.joint(c) + i)] / std::sqrt(m_rows[r]->K);
    }
  moveTo(m_island, m_component, m_tier, to);
}

// J times the change of velocities that is in x.
double Solve::along(const RowJacobian& J, int c, const std::vector<double>& x) const {
  double sum = 0;
  for (int side = 0; side < 2; ++side) {
    const int number = joint(c).body[size_t(side)];
    if (number < 0) continue;
    const IslandBody& of = m_island.bodies[size_t(number)];
    const double* const d = &x[size_t(m_fronts.body(number - m_component.first_body))];
    const Vector3d &L = side ? J.L_b : J.L_a, &A = side ? J.A_b : J.A_a;
    for (int k = 0; k < 3; ++k) {
      if (!of.locked[size_t(k)]) sum += L[k] * d[k] / of.scale[0];
      if (!of.locked[size_t(3 + k)]) sum += A[k] * d[3 + k] / of.scale[1];
    }
  }
  return sum;
}

// Rows with bounds keep their impulses.
void Solve::keepBounded(const Iterate& at) {
  for (size_t r = 0; r < m_rows.size(); ++r)
    if (!m_rows[r]->law.isEquality()) m_work.pieces[r] = {false, 0, 0, at.lambda[r]};
}

// x: the correction by equalities alone, with the last factor, becomes that with all rows with bounds on their laws.
void Solve::findBoundedCorrection(std::vector<double>& x) {
  std::vector<BoundedRow> rows;
  std::vector<std::pair<int, int>> place;  // joint, and row of all
  for (int c = 0; c < m_component.joints; ++c)
    for (int i = 0; i < joint(c).rows; ++i) {
      const int r = m_first[size_t(c)] + i;
      if (m_rows[size_t(r)]->law.isEquality()) continue;
      const RowAtEnd& row = m_work.now.rows[size_t(r)];
      rows.push_back(
          {&m_rows[size_t(r)]->law, row.u + along(row.J, c, x), m_work.now.lambda[size_t(r)]});
      place.push_back({c, r});
    }
  const size_t n = rows.size();
  std::vector<std::vector<double>> response(n);
  std::vector<double> W(n * n);
  for (size_t k = 0; k < n; ++k) {
    const auto [c, r] = place[k];
    response[k].assign(x.size(), 0.);
    response[k][size_t(m_fronts.joint(c) + r - m_first[size_t(c)])] =
        std::sqrt(m_rows[size_t(r)]->K);
    m_fronts.solve(response[k].data());
    for (size_t j = 0; j < n; ++j)
      W[j * n + k] = along(m_work.now.rows[size_t(place[j].second)].J, place[j].first, response[k]);
  }
  std::vector<double> before(n);
  for (size_t k = 0; k < n; ++k) before[k] = rows[k].lambda;
  solveBounded(rows, W, m_options.newton_tolerance / m_island.dt / 10, m_options.max_sweeps);
  for (size_t k = 0; k < n; ++k)
    for (size_t i = 0; i < x.size(); ++i) x[i] += (rows[k].lambda - before[k]) * response[k][i];
}

// With every row on the piece of its law that it is nearest to.
bool Solve::isConverged(const Iterate& at) {
  choosePieces(at, m_work.pieces);
  findResidual(at, m_work.residual);
  return m_error <= m_options.newton_tolerance &&
         m_momentum2 <= m_options.momentum_tolerance * m_options.momentum_tolerance * m_scale2;
}

bool Solve::factoriseMotion(const std::vector<char>& acts) {
  Iterate& at = m_work.now;
  at.horizon = m_island.dt;
  moveTo(m_island, m_component, Tier::start, at);
  for (size_t r = 0; r < m_rows.size(); ++r) {
    at.rows[r].G = at.rows[r].J;
    m_work.pieces[r] = {acts[r] != 0, 0, 0, 0};
  }
  m_work.stiffness.assign(size_t(m_component.bodies), Matrix3d::Zero());
  assemble(at);
  return m_fronts.factorise();
}

NewtonReport Solve::run() {
  NewtonReport report;
  Iterate& now = m_work.now;
  m_work.next.horizon = now.horizon;
  m_work.next.bodies.resize(now.bodies.size());
  m_work.next.lambda.resize(m_rows.size());
  m_work.next.rows.resize(m_rows.size());
  now.rows.resize(m_rows.size());
  m_scale2 = 1e-18;
  for (int i = 0; i < m_component.bodies; ++i) {
    const IslandBody& of = body(i);
    m_scale2 += of.mass * of.v_free.head<3>().squaredNorm() +
                of.v_free.tail<3>().dot(of.inertia * of.v_free.tail<3>());
  }
  const double tiny = 1e-10 * std::sqrt(m_scale2);
  const int max_factors =
      m_tier == Tier::start ? m_options.max_first_tier_factors : m_options.max_newton_iterations;
  std::vector<double>&x = m_work.correction, &y = m_work.simplified;
  std::vector<LawPiece>& pieces_before = m_work.next_pieces;
  bool fresh = false;  // the correction is known, by the last factor
  double length = 0;
  int tangents = 0, changes = 0;
  moveTo(m_island, m_component, m_tier, now);
  choosePieces(now, m_work.pieces);
  for (;;) {
    if (m_bounded) keepBounded(now);
    if (!fresh) {
      if (report.factors >= max_factors) return report;
      assemble(now);
      ++report.factors;
      if (!m_fronts.factorise()) return report;
      findResidual(now, x);
      m_fronts.solve(x.data());
    }
    if (m_bounded) findBoundedCorrection(x);
    length = velocityNorm(m_fronts, x);
    double part = 1, left = 0;
    bool accepted = false;
    for (; part > (m_tier == Tier::gradient ? min_part : short_step); part /= 2) {
      step(x, part);
      if (m_bounded) keepBounded(m_work.next);
      findResidual(m_work.next, y);
      m_fronts.solve(y.data());
      left = velocityNorm(m_fronts, y);
      accepted = left <= (1 - part / 4) * length || length < tiny;
      if (accepted) break;
    }
    if (!accepted || part < short_step) {
      if (fresh) {  // a factor that is too old
        fresh = false;
        continue;
      }
      if (m_tier != Tier::gradient) return report;
      // The other tangent; if that gets no further, as far as it goes.
      m_exact = !m_exact;
      if (++tangents < 2) continue;
      if (!accepted) return report;
    }
    tangents = 0;
    std::swap(m_work.now, m_work.next);
    ++report.steps;
    pieces_before = m_work.pieces;
    report.converged = isConverged(now);
    report.error = m_error;
    if (report.converged || report.steps >= m_options.max_newton_iterations) return report;
    bool same = true;
    for (size_t i = 0; i < m_rows.size() && same; ++i) {
      const LawPiece &before = pieces_before[i], &after = m_work.pieces[i];
      same = before.acts == after.acts && before.target == after.target &&
             before.softness == after.softness && before.impulse == after.impulse;
    }
    changes = same ? 0 : changes + 1;
    fresh = (same || m_bounded) && part == 1 && left <= m_options.contraction * length;
    if (changes > m_options.max_set_changes && !m_bounded) {
      m_bounded = true;
      fresh = false;
    }
    if (fresh) x.swap(y);
  }
}

}  // namespace

void moveTo(const Island& island, const Component& component, Tier tier, Iterate& at) {
  for (int i = 0; at.horizon > 0 && i < component.bodies; ++i)
    moveBody(island.bodies[size_t(component.first_body + i)], at.horizon, at.bodies[size_t(i)]);
  int first = 0;
  for (int c = 0; c < component.joints; ++c) {
    const IslandJoint& joint = island.joints[size_t(component.first_joint + c)];
    moveRows(island, joint, component, tier, at, first);
    first += joint.rows;
  }
}

bool factoriseMotion(const Island& island, const Component& component, const SolverOptions& options,
                     const std::vector<char>& acts, Fronts& fronts, Workspace& work) {
  return Solve(island, component, Tier::start, options, fronts, work).factoriseMotion(acts);
}

NewtonReport solve(const Island& island, const Component& component, Tier tier,
                   const SolverOptions& options, Fronts& fronts, Workspace& work) {
  return Solve(island, component, tier, options, fronts, work).run();
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
