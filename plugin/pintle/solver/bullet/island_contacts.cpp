// Contacts and friction, from Bullet's rows.
#include <pintle/solver/bullet/island_builder.h>

#include <BulletCollision/NarrowPhaseCollision/btManifoldPoint.h>

#include <algorithm>

namespace pintle {
inline namespace PINTLE_PRECISION {

namespace {

// m/s: the part of a contact's target that leads its bodies out of each other, and is no rebound.
double recoveryOf(const btSolverConstraint& from, double target, const btContactSolverInfo& info) {
  const auto* const point = static_cast<const btManifoldPoint*>(from.m_originalContactPoint);
  if (point == nullptr || !(target > 0)) return 0;
  const double depth = -double(point->getDistance() + info.m_linearSlop);
  return std::min(target, std::max(0., depth) * double(info.m_erp2) / double(info.m_timeStep));
}

}  // namespace

void IslandBuilder::addContacts(btConstraintArray& rows, const SolverBodies& bodies,
                                bool are_friction, std::vector<ContactRow>& to) {
  const Vector6d zero = Vector6d::Zero();
  for (int i = 0; i < rows.size(); ++i) {
    btSolverConstraint& from = rows[i];
    ContactRow& row = to.emplace_back();
    // Bullet's target of a contact has the velocities of bodies that their owner moves.
    const auto bodyOf = [&](int number) {
      return std::max(body(bodies, number), Island::unmoved(Island::at_rest));
    };
    row.body = {bodyOf(from.m_solverBodyIdA), bodyOf(from.m_solverBodyIdB)};
    row.J = {inDouble(from.m_contactNormal1), inDouble(from.m_relpos1CrossNormal),
             inDouble(from.m_contactNormal2), inDouble(from.m_relpos2CrossNormal)};
    // Bullet has both multiplied by its own 1 / K.
    const double inverse_K = double(from.m_jacDiagABInv);
    const auto free = [&](int of) { return of < 0 ? zero : m_island.bodies[size_t(of)].v_free; };
    row.target = inverse_K > 0 ? double(from.m_rhs) / inverse_K +
                                     row.J.along(free(row.body[0]), free(row.body[1]))
                               : 0;
    if (!are_friction) row.recovery = recoveryOf(from, row.target, m_info);
    row.softness = inverse_K > 0 ? double(from.m_cfm) / inverse_K : 0;
    row.lower = double(from.m_lowerLimit);
    row.upper = double(from.m_upperLimit);
    row.normal = are_friction ? from.m_frictionIndex : -1;
    row.friction = double(from.m_friction);
    row.impulse = double(from.m_appliedImpulse);
    row.from = &from;
  }
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
