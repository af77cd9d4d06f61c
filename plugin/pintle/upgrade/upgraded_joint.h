// Purpose: a joint of Pintle's in the place of a stock one, of which it has the settings, while a solver is at work. The stock object
// stays in the world, and gets what a step of its own would leave there.
#pragma once

#include <pintle/precision.h>

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>

#include <cstddef>
#include <memory>

namespace pintle {
inline namespace PINTLE_PRECISION {

class Joint;
struct StockClass;

/// How the joints are solved.
enum class SolvedBy : unsigned char { iterations, exact_solver };

/// The class of a constraint, if it is exactly one of Bullet's that has a counterpart here for such a solver; else null: a client's subclass
/// has rows of its own.
const StockClass* stockClassOf(const btTypedConstraint& constraint, SolvedBy solver);

/// The joint as Bullet's solver sees it: a constraint with the bodies of the stock one.
class UpgradedJoint : public btTypedConstraint {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();
  /// `stock` is of this class.
  static std::unique_ptr<UpgradedJoint> make(const StockClass& of, btTypedConstraint& stock);

  /// The rows and settings. Its constraint() is the stock object.
  virtual Joint& joint() = 0;
  /// Memory, without that of its rows.
  virtual std::size_t bytes() const = 0;

  /// True while the object at this address is the one that was solved last: it has the same class and bodies, and the impulse that
  /// markSolved left there.
  bool standsFor(const StockClass& of, btTypedConstraint& stock) const;
  /// Takes over what Bullet's solver asks a constraint for beside its rows.
  void beginSolve();
  /// Leaves the impulse in the stock object, and disables it if the joint has broken.
  void endSolve();
  /// Keeps the impulse in the stock object to know it again. No impulse is written as -0, for a constructor leaves +0.
  void markSolved();

  void setParam(int num, btScalar value, int axis) override;
  btScalar getParam(int num, int axis) const override;

 protected:
  explicit UpgradedJoint(btTypedConstraint& stock)
      : btTypedConstraint(stock.getConstraintType(), stock.getRigidBodyA(), stock.getRigidBodyB()),
        m_stock(stock) {}

  btTypedConstraint& m_stock;

 private:
  const StockClass* m_class = nullptr;
  btScalar m_mark = 0;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
