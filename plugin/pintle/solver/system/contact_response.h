// Purpose: what impulses of contacts, and of other rows that can yield, do to their velocities, while equalities of joints hold: their
// Schur complement
//   u = S p,   S = J A^-1 J^T - R^T K^-1 R,   K = L D L^T of the joints, R: what impulses of 1 do to their rows
// Of Y = L^-1 R a contact has numbers only on the paths of its bodies' joints to the root of the factor. So an impulse adds to a state of
// bodies and joints, and a contact reads its velocity from it, at those few places. Each contact sees what all others have done, through
// any joints, as in Gauss and Seidel's method with the whole matrix.
#pragma once

#include <pintle/solver/linalg/memory.h>
#include <pintle/solver/model/contacts.h>
#include <pintle/solver/system/joint_matrix.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

class ContactResponse {
 public:
  /// An island with so many bodies: no contact is known, and no joint.
  void begin(size_t bodies) {
    m_parts.clear();
    m_components.clear();
    m_bodies.assign(bodies, {});
    m_state.assign(body_size * bodies, 0.);
  }
  /// Joints of a component: they are left out, until they have a factor.
  void addJoints(const Component& component, JointMatrix& joints);
  /// Of the components that these rows are on: leaves out all joints of one where paths may have more than `longest` blocks, and those of
  /// the rows would take more memory than its matrix. Returns whether none is left out.
  bool leaveOutLongPaths(Span<const ContactRow> rows, int longest);
  /// They have one, another than before.
  void takeFactor(int first, JointMatrix& joints);
  /// M^-1 J^T of each body of the row, and K of these alone.
  void begin(const Island& island, ContactRow& row) const;
  /// Again, if a body of the row has another factor: its response is then found anew.
  void forgetOld(const Island& island, ContactRow& row) const {
    const auto isNew = [this](int body) { return body >= 0 && m_bodies[size_t(body)].is_new; };
    if (isNew(row.body[0]) || isNew(row.body[1])) begin(island, row);
  }

  /// The state of a body.
  void setVelocity(int body, const Vector6d& v);
  /// Those of the joints of the bodies from `first` on are at rest.
  void rest(int first, const JointMatrix& joints);
  /// All of them, and all bodies.
  void rest() { std::fill(m_state.begin(), m_state.end(), 0.); }
  /// One pass over rows, each with the velocity that all before it have left. Returns the largest change of one, m/s or rad/s. What is
  /// not known of a row (ContactRow::parts) is found when it is needed: a contact that does not press has no friction.
  double sweep(Span<ContactRow> rows);
  size_t bytes() const { return bytesOf(m_bodies, m_components, m_state) + m_parts.bytes(); }

 private:
  static constexpr size_t lanes = block_stride, body_size = 2 * lanes;
  struct Body {
    const InverseInertia* inertia = nullptr;  ///< null: no joint holds it
    JointMatrix* joints = nullptr;            ///< with a factor; null: they are left out
    int number = 0;                           ///< among the bodies of that
    size_t component = 0;                     ///< whose joints hold it
    bool is_new = false;                      ///< rows do not know the factor
  };
  struct Joints {
    const JointMatrix* K;
    size_t at;  ///< in the state
    bool is_anchored;
    size_t path_blocks = 0;  ///< that all paths have at most
    bool are_left_out = false;
  };

  void find(ContactRow& row);
  bool isConfined(const ContactRow& row) const;
  void addBody(const ContactRow& row, int side, bool is_unknown);
  void addPath(const Body& of, int a, int b, const RowJacobian& J);

  std::vector<Body> m_bodies;
  std::vector<Joints> m_components;
  PathBlocks m_parts;  ///< of rows, each side by side
  std::vector<double>
      m_state;  ///< of each body three and a zero, twice, and the unknowns of joints
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
