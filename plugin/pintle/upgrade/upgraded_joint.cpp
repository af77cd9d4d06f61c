#include <pintle/upgrade/upgraded_joint.h>

#include <pintle/bullet/stock_hinge.h>
#include <pintle/finite.h>
#include <pintle/joints/ball_joint.h>
#include <pintle/joints/cone_twist_model.h>
#include <pintle/joints/gear_model.h>
#include <pintle/joints/quaternion_hinge.h>
#include <pintle/joints/six_dof_model.h>
#include <pintle/joints/slider_joint.h>

#include <BulletDynamics/ConstraintSolver/btConeTwistConstraint.h>
#include <BulletDynamics/ConstraintSolver/btFixedConstraint.h>
#include <BulletDynamics/ConstraintSolver/btGeneric6DofSpringConstraint.h>
#include <BulletDynamics/ConstraintSolver/btHinge2Constraint.h>
#include <BulletDynamics/ConstraintSolver/btHingeConstraint.h>
#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <BulletDynamics/ConstraintSolver/btSliderConstraint.h>
#include <BulletDynamics/ConstraintSolver/btUniversalConstraint.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <typeinfo>

namespace pintle {
inline namespace PINTLE_PRECISION {

struct StockClass {
  const std::type_info& type;
  std::unique_ptr<UpgradedJoint> (*make)(btTypedConstraint& stock);
  /// Not by iterations.
  bool by_exact_solver_alone;
};

namespace {

/// `Model`, a Joint, for an object of the class `Stock` that it is no part of.
template <class Stock, class Model>
class UpgradedOf : public UpgradedJoint, protected Model {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();
  explicit UpgradedOf(Stock& stock) : UpgradedJoint(stock), Model(stock, Model::row_count) {}

  Joint& joint() override { return *this; }
  std::size_t bytes() const override { return sizeof *this; }
  void buildJacobian() override { Model::buildJacobian(); }
  void getInfo1(btConstraintInfo1* info) override { Model::announceRows(*info); }
  void getInfo2(btConstraintInfo2* info) override { Model::writeRows(*info); }
  void solveConstraintObsolete(btSolverBody& a, btSolverBody& b, btScalar) override {
    Model::afterPass(a, b);
    // A joint that breaks in a pass gets no others.
    if (!m_stock.isEnabled()) setEnabled(false);
  }
};

/// Turns are counted in the stock object: it lives longer than this, and clients set its count.
class UpgradedAccumulatedHinge final
    : public UpgradedOf<btHingeAccumulatedAngleConstraint, QuaternionHingeModel> {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();
  explicit UpgradedAccumulatedHinge(btHingeAccumulatedAngleConstraint& stock)
      : UpgradedOf(stock), m_angle(accumulatedAngle(stock)) {}

 private:
  void prepare(const PosePair& poses, Rows& rows) override {
    const Scalar before = m_angle;
    QuaternionHingeModel::prepare(poses, rows);
    // Bullet's getter moves the count by less than half a turn.
    const bool is_known = isNumber(m_shown) && btFabs(before - m_shown) <= SIMD_PI;
    if (!is_known && isFinite(before)) m_turns_before = std::round((before - m_angle) / SIMD_2_PI);
    m_shown = m_angle += SIMD_2_PI * m_turns_before;
  }

  btScalar& m_angle;  ///< rad, of the stock object
  /// rad: what the last step left there
  Scalar m_shown = std::numeric_limits<Scalar>::quiet_NaN();
  Scalar m_turns_before = 0;  ///< that this has not seen
};

template <class Stock, class Upgraded>
StockClass upgradeBy(bool by_exact_solver_alone = false) {
  return {typeid(Stock),
          [](btTypedConstraint& stock) -> std::unique_ptr<UpgradedJoint> {
            return std::make_unique<Upgraded>(static_cast<Stock&>(stock));
          },
          by_exact_solver_alone};
}
template <class Stock, class Model>
StockClass upgrade() {
  return upgradeBy<Stock, UpgradedOf<Stock, Model>>();
}
// (Iterations leave springs of loops, as of a skirt, to shake: 29 rad/s at rest, where those of Bullet's, which clamps them, have 4.6.)
template <class Stock, class Model>
StockClass upgradeOnExactSolver() {
  return upgradeBy<Stock, UpgradedOf<Stock, Model>>(true);
}

const StockClass* lookUp(const std::type_info& type) {
  static const StockClass all[] = {
      upgrade<btHingeConstraint, QuaternionHingeModel>(),
      upgradeBy<btHingeAccumulatedAngleConstraint, UpgradedAccumulatedHinge>(),
      upgrade<btPoint2PointConstraint, BallModel>(),
      upgrade<btSliderConstraint, SliderModel>(),
      upgrade<btConeTwistConstraint, ConeTwistModel>(),
      upgrade<btGearConstraint, GearModel>(),
      upgradeOnExactSolver<btGeneric6DofConstraint, SixDofModel>(),
      upgradeOnExactSolver<btGeneric6DofSpringConstraint, SixDofModel>(),
      upgradeOnExactSolver<btGeneric6DofSpring2Constraint, SixDofModel>(),
      upgradeOnExactSolver<btHinge2Constraint, SixDofModel>(),
      upgrade<btFixedConstraint, SixDofModel>(),
      upgrade<btUniversalConstraint, SixDofModel>(),
  };
  for (const StockClass& of : all)
    if (of.type == type) return &of;
  return nullptr;
}

}  // namespace

// To compare types may take comparisons of names: so each is looked up once.
const StockClass* stockClassOf(const btTypedConstraint& constraint, SolvedBy solver) {
  struct Known {
    const std::type_info* type = nullptr;
    const StockClass* stock = nullptr;
  };
  thread_local std::array<Known, 16> all;
  const std::type_info& type = typeid(constraint);
  Known& known = all[reinterpret_cast<std::uintptr_t>(&type) / 16 % all.size()];
  if (known.type != &type) known = {&type, lookUp(type)};
  const StockClass* const of = known.stock;
  const bool is_left = of != nullptr && of->by_exact_solver_alone && solver == SolvedBy::iterations;
  return is_left ? nullptr : of;
}

std::unique_ptr<UpgradedJoint> UpgradedJoint::make(const StockClass& of, btTypedConstraint& stock) {
  std::unique_ptr<UpgradedJoint> made = of.make(stock);
  made->m_class = &of;
  return made;
}

bool UpgradedJoint::standsFor(const StockClass& of, btTypedConstraint& stock) const {
  return m_class == &of && &stock == &m_stock && &stock.getRigidBodyA() == &getRigidBodyA() &&
         &stock.getRigidBodyB() == &getRigidBodyB() &&
         isSame(stock.internalGetAppliedImpulse(), m_mark);
}

void UpgradedJoint::beginSolve() {
  setBreakingImpulseThreshold(m_stock.getBreakingImpulseThreshold());
  setEnabled(m_stock.isEnabled());
  setOverrideNumSolverIterations(m_stock.getOverrideNumSolverIterations());
  setJointFeedback(m_stock.getJointFeedback());
}

void UpgradedJoint::endSolve() {
  m_stock.internalSetAppliedImpulse(internalGetAppliedImpulse());
  if (!isEnabled()) m_stock.setEnabled(false);
  markSolved();
}

void UpgradedJoint::markSolved() {
  if (m_stock.internalGetAppliedImpulse() == 0) m_stock.internalSetAppliedImpulse(-Scalar(0));
  m_mark = m_stock.internalGetAppliedImpulse();
}

void UpgradedJoint::setParam(int num, btScalar value, int axis) {
  m_stock.setParam(num, value, axis);
}

btScalar UpgradedJoint::getParam(int num, int axis) const { return m_stock.getParam(num, axis); }

}  // namespace PINTLE_PRECISION
}  // namespace pintle
