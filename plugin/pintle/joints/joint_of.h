// Purpose: a constraint of Bullet's with the rows of a joint: the one way from Bullet's virtual functions to joint.h.
#pragma once

#include <pintle/joints/joint.h>

#include <type_traits>
#include <utility>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// `Stock`, a class of Bullet's or one that derives from it, with the rows of `Model`, a Joint. (Bullet's comes first: clients cast
/// pointers to it in C style.)
template <class Stock, class Model>
class JointOf : public Stock, public Model {
 public:
  /// Bullet's solver calls this and the next three. A subclass that overrides getInfo1 or getInfo2 calls it, too, once a step: getInfo2 without
  /// getInfo1 gives Bullet's own rows where its own would be more than Bullet announces.
  void buildJacobian() override {
    m_is_announced = false;
    Model::buildJacobian();
  }
  /// Counts the rows of the step.
  void getInfo1(btTypedConstraint::btConstraintInfo1* info) override {
    m_is_announced = true;
    Model::announceRows(*info);
  }
  /// Writes the rows of the step.
  void getInfo2(btTypedConstraint::btConstraintInfo2* info) override {
    if (!m_is_announced && !fitsIntoStocks()) return askStock(info);
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
  static constexpr bool has_rows_of_stock = !std::is_same<Stock, btTypedConstraint>::value;

  // Of a client's getInfo1, which did not ask for the rows, the number is not known: it can only be that of Bullet's.
  bool fitsIntoStocks() {
    btTypedConstraint::btConstraintInfo1 own;
    Model::announceRows(own);
    if constexpr (has_rows_of_stock) {
      btTypedConstraint::btConstraintInfo1 stock;
      Stock::getInfo1(&stock);
      return own.m_numConstraintRows <= stock.m_numConstraintRows;
    }
    return true;
  }
  void askStock(btTypedConstraint::btConstraintInfo2* info) {
    if constexpr (has_rows_of_stock) Stock::getInfo2(info);
  }

  bool m_is_announced = false;
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
