# A migration to Pintle: the types' names, and nothing else. Headers keep theirs; a forward declaration is not needed.
/^[ \t]*#[ \t]*include/b
/^[ \t]*class[ \t]\{1,\}bt\(Hinge\|HingeAccumulatedAngle\|Point2Point\|Slider\|ConeTwist\|Universal\|Fixed\)Constraint;/d
s/\bbtHingeConstraint\b/pintle::QuaternionHinge/g
s/\bbtHingeAccumulatedAngleConstraint\b/pintle::QuaternionHinge/g
s/\bbtPoint2PointConstraint\b/pintle::BallJoint/g
s/\bbtSliderConstraint\b/pintle::SliderJoint/g
s/\bbtConeTwistConstraint\b/pintle::ConeTwistJoint/g
s/\bbtUniversalConstraint\b/pintle::UniversalJoint/g
s/\bbtFixedConstraint\b/pintle::FixedJoint/g
