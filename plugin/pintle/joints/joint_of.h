// Purpose: a constraint of Bullet's with the rows of a joint: the one way from Bullet's virtual functions to joint.h.
#pragma once

#include <pintle/joints/joint.h>

#include <utility>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// `Stock`, a class of Bullet's or one that derives from it, with the rows of `Model`, a Joint. (Bullet's comes first: clients cast
/// pointers to it in C style.)
template <class Stock, class Model>
class JointOf : public Stock, public Model {
 public:
  /// Bullet's solver calls this and the next three. A subclass that overrides getInfo1 calls it, too, once a step: else getInfo2 has
  /// as many rows as Bullet's own getInfo1 last announced, and what acts beyond them is left out.
  void buildJacobian() override {
    if (m_is_written) m_is_announced = false;
    Model::buildJacobian();
  }
  /// Counts the rows of the step.
  void getInfo1(btTypedConstraint::btConstraintInfo1* info) override {
    m_is_announced = true;
    m_is_written = false;
    Model::announceRows(*info);
  }
  /// Writes the rows of the step.
  void getInfo2(btTypedConstraint::btConstraintInfo2* info) override {
    if (!m_is_announced) {
      btTypedConstraint::btConstraintInfo1 own;
      Model::announceRows(own, Model::rowsOfStock(*this));
      Model::hideLimits();
    }
    m_is_written = true;
    Model::writeRows(*info);
  }
  /// Comes after each iteration over the rows of all joints.
  void solveConstraintObsolete(btSolverBody& a, btSolverBody& b, btScalar) override {
    Model::afterPass(a, b);
  }

 protected:
  /// `arguments`: those of a constructor of Stock.
  template <class... Arguments>
  explicit JointOf(RowCount max_rows, Arguments&&... arguments)
      : Stock(std::forward<Arguments>(arguments)...), Model(static_cast<Stock&>(*this), max_rows) {}

 private:
  bool m_is_announced = false;  ///< by getInfo1 here, in this step
  bool m_is_written = false;    ///< since
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
