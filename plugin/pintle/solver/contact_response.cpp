#include <pintle/solver/contact_response.h>

#include <pintle/solver/solver_options.h>

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

PINTLE_TARGET_CLONES double readFrom(const double* state, const PathBlock* part,
                                     const PathBlock* end) {
  return read(state, part, end);
}
PINTLE_TARGET_CLONES void addTo(double* state, double impulse, const PathBlock* part,
                                const PathBlock* end) {
  add(state, impulse, part, end);
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
    if (!(row.K > 0)) continue;
    const PathBlock* const first = parts + row.first_part;
    const PathBlock* const end = first + row.parts;
    const double next = row.meet(read(state, first, end)), by = next - row.impulse;
    if (by == 0) continue;
    row.impulse = next;
    add(state, by, first, end);
    largest = std::fmax(largest, std::abs(row.K * by));
  }
  return count;
}

}  // namespace

void ContactResponse::addJoints(int first, JointMatrix& joints) {
  for (size_t i = 0; i < joints.bodies().size(); ++i) {
    Body& body = m_bodies[size_t(first) + i];
    body = {};
    body.inertia = &joints.bodies()[i];
    body.number = int(i);
    body.component = m_components.size();
  }
  m_components.push_back({&joints, m_state.size()});
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

double ContactResponse::findAnswers(const Island& island, ContactRow& row) const {
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
  return K;
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
  row.K = findK(m_parts.begin() + row.first_part, m_parts.end());
  if (!(row.K > rounding_share * K_alone)) row.K = 0;  // joints hold it
}

void ContactResponse::push(Span<ContactRow> rows, double part) {
  for (ContactRow& row : rows) {
    if (row.impulse == 0) continue;
    if (row.parts == 0) find(row);
    const PathBlock* const first = m_parts.begin() + row.first_part;
    addTo(m_state.data(), part * row.impulse, first, first + row.parts);
  }
}

double ContactResponse::slope(Span<ContactRow> rows, double part) {
  double sum = 0;
  for (ContactRow& row : rows) {
    if (row.impulse == 0) continue;
    if (row.parts == 0) find(row);
    const PathBlock* const first = m_parts.begin() + row.first_part;
    const double u = readFrom(m_state.data(), first, first + row.parts);
    sum += row.impulse * (u + part * row.softness * row.impulse - row.target);
  }
  return sum;
}

double ContactResponse::sweep(Span<ContactRow> rows) {
  double largest = 0;
  for (size_t i = 0;;) {
    i = sweepRows(i, rows.begin(), rows.size(), m_parts.begin(), m_state.data(), largest);
    if (i == rows.size()) return largest;
    find(rows[i]);
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
