// Purpose: from what a joint observes at a pose to its rows, once for all joints. A joint `Self` has
//   struct Observation             where its frames are, and its angles there, the nearest to those that it remembers;
//                                  `sum()` is no number if one of its numbers is none, as in a frame that its owner
//                                  has spoiled
//   Observation observe(const PosePair&) const
//   void remember(Observation&, bool in_step)    takes its angles over: in each step, and when somebody asks. Only here do
//                                  velocities count: of bodies that turn fast a pose does not tell the turns
//   void constrain(const Observation&, Rows&) const    adds the rows
// which this class is a friend of, and its .cpp file instantiates this class (joints/observed_joint_rows.h).
#pragma once

#include <pintle/joints/joint.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

/// The way from a pose to rows of a joint that counts the turns of its angles.
template <class Self, class Base>
class ObservedJoint : public Base {
 public:
  /// As Joint has it.
  PINTLE_FLATTEN void addRows(const PosePair& poses, Rows& rows) const override;

 protected:
  using Base::Base;

  void updateState(const PosePair& poses) override;
  PINTLE_FLATTEN void prepare(const PosePair& poses, Rows& rows) override;

 private:
  Self& self() { return static_cast<Self&>(*this); }
  const Self& self() const { return static_cast<const Self&>(*this); }
};

}  // namespace PINTLE_PRECISION
}  // namespace pintle
