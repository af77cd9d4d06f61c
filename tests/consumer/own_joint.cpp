// A joint of one's own.
#include <pintle/extend.h>

namespace {

// A constant distance between the centres.
class Rod : public pintle::StandaloneJoint {
 public:
  Rod(btRigidBody& a, btRigidBody& b, btScalar length)
      : StandaloneJoint(a, b, pintle::RowCount{1}), m_length(positive("length", length)) {}

  const char* name() const override { return "Rod"; }
  void addRows(const pintle::PosePair& poses, pintle::Rows& rows) const override {
    const pintle::Vec3 d = poses.x_b() - poses.x_a(), none = pintle::Vec3::Zero();
    const btScalar length = d.norm();
    if (pintle::PosePair::is_finite(length) && length > 0)
      rows.addEquality(d / length, none, none, length - m_length);
  }
  void drawJoint(btIDebugDraw&) const override {}
  void setParam(int num, btScalar value, int) override {
    if (num != BT_CONSTRAINT_ERP) reject("parameter", num, "no such parameter");
    m_erp = notNegative("ERP", value);
  }
  btScalar getParam(int, int) const override { return m_erp.orElse(0); }

 private:
  btScalar m_length;
};

}  // namespace

int main() {
  btRigidBody a(1, nullptr, nullptr, btVector3(1, 1, 1)),
      b(1, nullptr, nullptr, btVector3(1, 1, 1));
  b.setCenterOfMassTransform(btTransform(btQuaternion::getIdentity(), btVector3(2, 0, 0)));
  Rod rod(a, b, 2);
  rod.buildJacobian();
  btTypedConstraint::btConstraintInfo1 info;
  rod.getInfo1(&info);
  return info.m_numConstraintRows == 1 ? 0 : 1;
}
