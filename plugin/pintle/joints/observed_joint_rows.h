// Purpose: the functions of ObservedJoint, for the joints' .cpp files only: there Observation is complete, and all is inlined.
#pragma once

#include <pintle/body_pair.h>
#include <pintle/joints/observed_joint.h>
#include <pintle/rows/row.h>

namespace pintle {
inline namespace PINTLE_PRECISION {

template <class Self, class Base>
void ObservedJoint<Self, Base>::addRows(const PosePair& poses, Rows& rows) const {
  const typename Self::Observation seen = self().observe(poses);
  if (PosePair::is_finite(seen.sum())) self().constrain(seen, rows);
}

template <class Self, class Base>
void ObservedJoint<Self, Base>::updateState(const PosePair& poses) {
  typename Self::Observation seen = self().observe(poses);
  self().remember(seen, false);
}

template <class Self, class Base>
void ObservedJoint<Self, Base>::prepare(const PosePair& poses, Rows& rows) {
  typename Self::Observation seen = self().observe(poses);
  self().remember(seen, true);
  if (PosePair::is_finite(seen.sum())) self().constrain(seen, rows);
}

}  // namespace PINTLE_PRECISION
}  // namespace pintle
