#include <pintle/solver/system/contact_response.h>

#include <pintle/solver/constants.h>

#include <algorithm>
#include <cmath>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace {

PINTLE_INLINE double read(const double* state, const PathBlock* part, const PathBlock* end) {
  FourLanes sum;
  for (; part != end; ++part) sum.add(FourLanes(part->reads), FourLanes(state + part->at));
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

PINTLE_INLINE void add(double* state, double impulse, const PathBlock* part, const PathBlock* end) {
  for (; part != end; ++part) {
    FourLanes to(state + part->at);
    to.add(FourLanes(part->adds), impulse);
    to.store(state + part->at);
  }
}

// What the parts give to themselves by an impulse of 1.
PINTLE_TARGET_CLONES double findK(const PathBlock* part, const PathBlock* end) {
  FourLanes sum;
  for (; part != end; ++part) sum.add(FourLanes(part->reads), FourLanes(part->adds));
  return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

// From row i on, up to the first one whose parts are not known. Returns which that is.
PINTLE_TARGET_CLONES size_t sweepRows(size_t i, ContactRow* rows, size_t count,
                                      const PathBlock* parts, double* state, double& largest) {
  for (; i < count; ++i) {
    ContactRow& row = rows[i];
    boundFriction({rows, count}, row);
    if (row.isFriction() && row.upper == 0 && row.impulse == 0) continue;
    if (row.parts == 0) return i;
    if (!(row.K + row.compliance > 0)) continue;
    const PathBlock* const first = parts + row.first_part;
    const PathBlock* const end = first + row.parts;
    const double next = row.meet(read(state, first, end)), by = next - row.impulse;
    if (by == 0) continue;
    row.impulse = next;
    add(state, by, first, end);
    largest = std::fmax(largest, std::abs((row.K + row.compliance) * by));
  }
  return count;
}

}  // namespace

void ContactResponse::addJoints(const Component& component, JointMatrix& joints) {
  for (size_t i = 0; i < joints.bodies().size(); ++i) {
    Body& body = m_bodies[size_t(component.first_body) + i];
    body = {};
    body.inertia = &joints.bodies()[i];
    body.number = int(i);
    body.component = m_components.size();
  }
  m_components.push_back({&joints, m_state.size(), component.is_anchored});
  m_state.resize(m_state.size() + joints.vectorSize(), 0.);
}

bool ContactResponse::leaveOutLongPaths(Span<const ContactRow> rows, int longest) {
  bool any = false;
  for (const ContactRow& row : rows)
    for (const int number : row.body) {
      if (number < 0 || m_bodies[size_t(number)].inertia == nullptr) continue;
      const Body& body = m_bodies[size_t(number)];
      Joints& joints = m_components[body.component];
      if (joints.K->longestPath() <= longest) continue;
      joints.path_blocks += size_t(joints.K->pathLength(body.number));
      joints.are_left_out = PathBlock::numbers * joints.path_blocks > joints.K->numbers();
      any = any || joints.are_left_out;
    }
  return !any;
}

void ContactResponse::takeFactor(int first, JointMatrix& joints) {
  for (size_t i = 0; i < joints.bodies().size(); ++i) {
    Body& body = m_bodies[size_t(first) + i];
    if (m_components[body.component].are_left_out) return;
    body.joints = &joints;
    body.is_new = true;
  }
}

void ContactResponse::begin(const Island& island, ContactRow& row) const {
  double K = 0;
  for (int side = 0; side < 2; ++side) {
    const int body = row.body[size_t(side)];
    if (body < 0) continue;
    const InverseInertia* const by = m_bodies[size_t(body)].inertia;
    const Vector3d &L = row.J.L(side), &A = row.J.A(side);
    Vector6d& answer = row.answer[size_t(side)];
    answer = by != nullptr ? by->answer(L, A) : island.bodies[size_t(body)].answer(L, A);
    K += row.J.along(side, answer);
  }
  row.begin(K);
}

void ContactResponse::setVelocity(int body, const Vector6d& v) {
  double* const to = m_state.data() + body_size * size_t(body);
  std::copy_n(v.data(), 3, to);
  std::copy_n(v.data() + 3, 3, to + lanes);
  m_bodies[size_t(body)].is_new = false;
}

void ContactResponse::rest(int first, const JointMatrix& joints) {
  std::fill_n(m_state.begin() + std::ptrdiff_t(m_components[m_bodies[size_t(first)].component].at),
              joints.vectorSize(), 0.);
}

// The velocity of a body that is an unknown of its joints changes with these alone.
void ContactResponse::addBody(const ContactRow& row, int side, bool is_unknown) {
  const Vector6d& answer = row.answer[size_t(side)];
  for (int half = 0; half < 2; ++half) {
    PathBlock& to = m_parts.add();
    to.at = body_size * size_t(row.body[size_t(side)]) + lanes * size_t(half);
    const Vector3d& J = half ? row.J.A(side) : row.J.L(side);
    for (int k = 0; k < 3; ++k) {
      to.reads[k] = J[k];
      to.adds[k] = is_unknown ? 0 : answer[3 * half + k];
    }
    to.reads[3] = to.adds[3] = 0;
  }
}

void ContactResponse::addPath(const Body& of, int a, int b, const RowJacobian& J) {
  const size_t first = m_parts.size();
  of.joints->findPath({a, b}, J, m_parts);
  for (PathBlock* part = m_parts.begin() + first; part != m_parts.end(); ++part)
    part->at += m_components[of.component].at;
}

// True where no body of the contact has a way out without its joints: both are of one component, or all that move hang on what does not.
bool ContactResponse::isConfined(const ContactRow& row) const {
  const Joints* joints[2] = {nullptr, nullptr};
  for (size_t side = 0; side < 2; ++side) {
    if (row.body[side] < 0) continue;
    const Body& body = m_bodies[size_t(row.body[side])];
    if (body.joints == nullptr) return false;
    joints[side] = &m_components[body.component];
  }
  if (joints[0] == joints[1]) return true;
  for (const Joints* of : joints)
    if (of != nullptr && !of->is_anchored) return false;
  return true;
}

// Bullet leads bodies out of each other by a velocity that no motion has. Where both are confined and K is small, a lever would
// make much of it: they get no more energy by it than they would get alone. A contact that equalities hold cannot move anything, nor can
// a limit that repeats others. Its compliance bounds its impulse.
void ContactResponse::find(ContactRow& row) {
  row.first_part = m_parts.size();
  double K_alone = 0;
  const Body* of[2] = {nullptr, nullptr};  // those that joints hold
  for (int side = 0; side < 2; ++side) {
    const int number = row.body[size_t(side)];
    if (number < 0) continue;
    const Body& body = m_bodies[size_t(number)];
    if (body.joints != nullptr) of[side] = &body;
    addBody(row, side, of[side] != nullptr && body.joints->isUnknown(body.number));
    K_alone += row.J.along(side, row.answer[size_t(side)]);
  }
  if (of[0] != nullptr && of[1] != nullptr && of[0]->joints == of[1]->joints) {
    addPath(*of[0], of[0]->number, of[1]->number, row.J);
  } else {
    if (of[0] != nullptr) addPath(*of[0], of[0]->number, -1, row.J);
    if (of[1] != nullptr) addPath(*of[1], -1, of[1]->number, row.J);
  }
  row.parts = unsigned(m_parts.size() - row.first_part);
  btAssert(row.parts > 0);  // else it would be asked for again
  row.K = std::fmax(0, findK(m_parts.begin() + row.first_part, m_parts.end()));
  const bool is_confined = row.from != nullptr && row.K < K_alone && isConfined(row);
  const double least = (is_confined || row.is_limit ? held_share : rounding_share) * K_alone;
  row.is_held = row.K < least;
  if (row.is_held) row.compliance = std::fmax(row.softness, least - row.K);
  if (is_confined && row.K > 0)
    row.aim -=
        row.recovery * std::fmax(0, 1 - (row.K + row.compliance) / std::sqrt(row.K * K_alone));
}

// Bullet's order, contacts and then their friction, lets friction lead bodies into each other where both act on one way to move. So
// contacts come once more.
double ContactResponse::sweep(Span<ContactRow> rows) {
  double largest = 0;
  const auto sweepTo = [&](size_t end) {
    for (size_t i = 0;;) {
      i = sweepRows(i, rows.begin(), end, m_parts.begin(), m_state.data(), largest);
      if (i == end) return;
      find(rows[i]);
    }
  };
  sweepTo(rows.size());
  const auto first_friction = std::partition_point(
      rows.begin(), rows.end(), [](const ContactRow& row) { return !row.isFriction(); });
  if (first_friction != rows.end()) sweepTo(size_t(first_friction - rows.begin()));
  return largest;
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
