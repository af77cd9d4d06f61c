// Serves Jolt's worlds to jolt.cpp: one process for all of them. A message is an array of doubles behind its length,
// also a double; each is answered by one. They come and go through descriptor 3, for Jolt writes to the others.
import {readSync, writeSync} from 'node:fs';
import {performance} from 'node:perf_hooks';
import threads from 'node:worker_threads';
import initJolt from 'jolt-physics/wasm-multithread';

// The package's flavour for threads is the one with SIMD, with which a step takes a quarter of the time. It waits for a
// pool of workers, which is then let go: all is done by this thread (mMaxWorkerThreads).
const pool = [];
threads.Worker = class extends threads.Worker {
  constructor(_, options) {
    super(new URL('worker.mjs', import.meta.url), options);
    pool.push(this);
  }
};
const alive = setInterval(() => {}, 1000);  // or else node ends while it waits
const Jolt = await initJolt();
clearInterval(alive);
for (const worker of pool) await worker.terminate();

const channel = 3;

const readAll = (buffer) => {
  for (let done = 0; done < buffer.byteLength;) {
    const count = readSync(channel, buffer, done, buffer.byteLength - done, null);
    if (count === 0) process.exit(0);  // who asked is gone
    done += count;
  }
};
const read = () => {
  const length = new Float64Array(1);
  readAll(new Uint8Array(length.buffer));
  const message = new Float64Array(length[0]);
  readAll(new Uint8Array(message.buffer));
  return message;
};
const write = (numbers) => {
  const bytes = new Uint8Array(Float64Array.of(numbers.length, ...numbers).buffer);
  for (let done = 0; done < bytes.length;) done += writeSync(channel, bytes, done, bytes.length - done);
};

// What Jolt has copied, or counts references to, once a world stands.
let borrowed = [];
const borrow = (object) => {
  borrowed.push(object);
  return object;
};
const giveBack = () => {
  for (const object of borrowed) Jolt.destroy(object);
  borrowed = [];
};
const vec = ([x, y, z]) => borrow(new Jolt.Vec3(x, y, z));
const point = ([x, y, z]) => borrow(new Jolt.RVec3(x, y, z));

// In the order in which jolt.cpp writes them.
const readBody = (next, vector) => ({
  mass: next(), inertia: vector(), position: vector(), turn: [...vector(), next()], velocity: vector(),
  spin: vector(), halfExtents: vector(), isSphere: next() > 0, collides: next() > 0, friction: next(),
  damping: next(), torque: vector(),
});
const readFrame = (vector) => ({origin: vector(), x: vector(), y: vector(), z: vector()});
const readJoint = (next, vector) => ({
  kind: next(), a: next(), b: next(), inA: readFrame(vector), inB: readFrame(vector), limited: next() > 0,
  low: next(), high: next(), aboutZ: next(), aboutY: next(), twist: next(), stiffness: next(), damping: next(),
  driven: next() > 0, maxTorque: next(),
});

const ghosts = 0, resting = 1, moving = 2;  // layers
const makeInterface = (bodies) => {
  const layers = 3, trees = 2;
  const collide = new Jolt.ObjectLayerPairFilterTable(layers);
  collide.EnableCollision(resting, moving);
  collide.EnableCollision(moving, moving);
  const treeOf = new Jolt.BroadPhaseLayerInterfaceTable(layers, trees);
  for (const layer of [ghosts, resting, moving])
    treeOf.MapObjectToBroadPhaseLayer(layer, borrow(new Jolt.BroadPhaseLayer(layer === resting ? 0 : 1)));
  const settings = borrow(new Jolt.JoltSettings());
  settings.mMaxWorkerThreads = 0;
  settings.mMaxBodies = bodies;
  // As large as needed: Jolt clears them in each step.
  settings.mMaxBodyPairs = settings.mMaxContactConstraints = 16 * bodies;
  settings.mObjectLayerPairFilter = collide;
  settings.mBroadPhaseLayerInterface = treeOf;
  settings.mObjectVsBroadPhaseLayerFilter = new Jolt.ObjectVsBroadPhaseLayerFilterTable(treeOf, trees, collide, layers);
  return new Jolt.JoltInterface(settings);
};

const makeShape = (body) => {
  if (body.isSphere) return new Jolt.SphereShape(body.halfExtents[0]);
  const usualRadius = 0.05;
  return new Jolt.BoxShape(vec(body.halfExtents), Math.min(usualRadius, ...body.halfExtents));
};

const makeBody = (bodies, from, group) => {
  const moves = from.mass > 0;
  const settings = borrow(new Jolt.BodyCreationSettings(
    makeShape(from), point(from.position), borrow(new Jolt.Quat(...from.turn)),
    moves ? Jolt.EMotionType_Dynamic : Jolt.EMotionType_Static, !from.collides ? ghosts : moves ? moving : resting));
  settings.mCollisionGroup = group;
  settings.mAllowSleeping = false;
  settings.mLinearVelocity = vec(from.velocity);
  settings.mAngularVelocity = vec(from.spin);
  settings.mMaxLinearVelocity = settings.mMaxAngularVelocity = 1e6;  // none
  settings.mLinearDamping = settings.mAngularDamping = 0;
  settings.mApplyGyroscopicForce = true;  // as Bullet does
  settings.mFriction = from.friction ** 2;  // Jolt takes the root of two bodies' product, Bullet the product
  if (moves) {
    settings.mOverrideMassProperties = Jolt.EOverrideMassProperties_MassAndInertiaProvided;
    settings.mMassPropertiesOverride.mMass = from.mass;
    settings.mMassPropertiesOverride.mInertia = Jolt.Mat44.prototype.sScaleVec3(vec(from.inertia));
  }
  const body = bodies.CreateBody(settings);
  bodies.AddBody(body.GetID(), Jolt.EActivation_Activate);
  return body;
};

// Joints: a is Jolt's first body, whose frame says where the axes are. Angles are those of b against a.
const setPoints = (settings, joint) => {
  settings.mPoint1 = point(joint.inA.origin);
  settings.mPoint2 = point(joint.inB.origin);
  return settings;
};
const setSpring = (spring, joint) => {
  spring.mMode = Jolt.ESpringMode_StiffnessAndDamping;
  spring.mStiffness = joint.stiffness;
  spring.mDamping = joint.damping;
};
const setLimits = (settings, joint) => {
  if (!joint.limited) return;
  settings.mLimitsMin = joint.low;
  settings.mLimitsMax = joint.high;
};

const makeBall = (joint) => setPoints(new Jolt.PointConstraintSettings(), joint);
const makeHinge = (joint) => {
  const settings = setPoints(new Jolt.HingeConstraintSettings(), joint);
  settings.mHingeAxis1 = vec(joint.inA.z);
  settings.mHingeAxis2 = vec(joint.inB.z);
  settings.mNormalAxis1 = vec(joint.inA.x);
  settings.mNormalAxis2 = vec(joint.inB.x);
  setLimits(settings, joint);
  settings.mMotorSettings.mMaxTorqueLimit = joint.maxTorque;
  settings.mMotorSettings.mMinTorqueLimit = -joint.maxTorque;
  return settings;
};
const makeSlider = (joint) => {
  const settings = setPoints(new Jolt.SliderConstraintSettings(), joint);
  settings.mAutoDetectPoint = false;
  settings.mSliderAxis1 = vec(joint.inA.x);
  settings.mSliderAxis2 = vec(joint.inB.x);
  settings.mNormalAxis1 = vec(joint.inA.y);
  settings.mNormalAxis2 = vec(joint.inB.y);
  setLimits(settings, joint);
  if (joint.stiffness > 0) {  // limits that give, both at 0
    settings.mLimitsMin = settings.mLimitsMax = 0;
    setSpring(settings.mLimitsSpringSettings, joint);
  }
  settings.mMotorSettings.mMaxForceLimit = joint.maxTorque;
  settings.mMotorSettings.mMinForceLimit = -joint.maxTorque;
  return settings;
};
const makeFixed = (joint) => {
  const settings = setPoints(new Jolt.FixedConstraintSettings(), joint);
  settings.mAutoDetectPoint = false;
  settings.mAxisX1 = vec(joint.inA.x);
  settings.mAxisX2 = vec(joint.inB.x);
  settings.mAxisY1 = vec(joint.inA.y);
  settings.mAxisY2 = vec(joint.inB.y);
  return settings;
};
// Its cone is an ellipse in sines of half angles. At the scenes' spans it differs from that in angles by less than 1e-4 rad.
const makeConeTwist = (joint) => {
  const settings = new Jolt.SwingTwistConstraintSettings();
  settings.mPosition1 = point(joint.inA.origin);
  settings.mPosition2 = point(joint.inB.origin);
  settings.mTwistAxis1 = vec(joint.inA.x);
  settings.mTwistAxis2 = vec(joint.inB.x);
  settings.mPlaneAxis1 = vec(joint.inA.z);  // Jolt's y is then our y
  settings.mPlaneAxis2 = vec(joint.inB.z);
  settings.mPlaneHalfConeAngle = joint.aboutY;
  settings.mNormalHalfConeAngle = joint.aboutZ;
  settings.mTwistMinAngle = -joint.twist;
  settings.mTwistMaxAngle = joint.twist;
  return settings;
};
// Of six degrees of freedom, a turn about z of a and one about y of b are free: Jolt's swing about its z, and its twist
// about its x, which is therefore our y.
const makeUniversal = (joint) => {
  const settings = new Jolt.SixDOFConstraintSettings();
  const minus = (v) => v.map((x) => -x);
  settings.mPosition1 = point(joint.inA.origin);
  settings.mPosition2 = point(joint.inB.origin);
  settings.mAxisX1 = vec(joint.inA.y);
  settings.mAxisX2 = vec(joint.inB.y);
  settings.mAxisY1 = vec(minus(joint.inA.x));
  settings.mAxisY2 = vec(minus(joint.inB.x));
  for (const axis of ['TranslationX', 'TranslationY', 'TranslationZ', 'RotationY'])
    settings.MakeFixedAxis(Jolt[`SixDOFConstraintSettings_EAxis_${axis}`]);
  return settings;
};
const makeDistance = (joint) => {
  const settings = setPoints(new Jolt.DistanceConstraintSettings(), joint);
  settings.mMinDistance = joint.low;
  settings.mMaxDistance = joint.high;
  if (joint.stiffness > 0) setSpring(settings.mLimitsSpringSettings, joint);
  return settings;
};

const kinds = [  // in the order of scenes::Kind; those that Jolt has none of do not come here
  {make: makeBall}, {make: makeHinge, made: Jolt.HingeConstraint}, {make: makeSlider, made: Jolt.SliderConstraint},
  {make: makeFixed}, {make: makeConeTwist}, {make: makeUniversal}, {}, {}, {}, {make: makeDistance},
];

class World {
  constructor(next) {
    const vector = () => [next(), next(), next()];
    const many = (readOne) => Array.from({length: next()}, () => readOne(next, vector));
    const gravity = next(), velocitySteps = next(), positionSteps = next();
    this.from = many(readBody);
    const joints = many(readJoint);
    this.world = makeInterface(this.from.length);
    const system = this.world.GetPhysicsSystem();
    system.SetGravity(vec([0, 0, -gravity]));
    const settings = system.GetPhysicsSettings();
    settings.mNumVelocitySteps = velocitySteps;
    settings.mNumPositionSteps = positionSteps;
    system.SetPhysicsSettings(settings);
    this.addBodies(system.GetBodyInterfaceNoLock(), joints);
    this.motors = joints.map((joint) => this.addJoint(system, joint));
    giveBack();
  }

  // Those that a joint connects do not collide with each other.
  addBodies(bodies, joints) {
    const filter = new Jolt.GroupFilterTable(this.from.length);
    for (const joint of joints) filter.DisableCollision(joint.a, joint.b);
    this.bodies = this.from.map((body, i) => makeBody(bodies, body, borrow(new Jolt.CollisionGroup(filter, 0, i))));
  }

  // The joint, if a motor is to be driven; else null.
  addJoint(system, from) {
    const {make, made} = kinds[from.kind];
    const settings = borrow(make(from));
    settings.mSpace = Jolt.EConstraintSpace_LocalToBodyCOM;
    const joint = settings.Create(this.bodies[from.a], this.bodies[from.b]);
    system.AddConstraint(joint);
    if (!from.driven) return null;
    const motor = Jolt.castObject(joint, made);
    motor.SetMotorState(Jolt.EMotorState_Velocity);
    return motor;
  }

  drive(dt, speeds) {
    this.motors.forEach((motor, i) => {
      if (motor instanceof Jolt.HingeConstraint) motor.SetTargetAngularVelocity(speeds[i]);
      if (motor instanceof Jolt.SliderConstraint) motor.SetTargetVelocity(speeds[i]);
    });
    this.from.forEach((from, i) => {
      if (from.damping > 0) {  // the part that Bullet takes away in a step, at the rate that Jolt asks for
        const rate = (1 - (1 - from.damping) ** dt) / dt, motion = this.bodies[i].GetMotionProperties();
        motion.SetLinearDamping(rate);
        motion.SetAngularDamping(rate);
      }
      if (from.torque.some((x) => x !== 0)) this.bodies[i].AddTorque(vec(from.torque));
    });
    giveBack();
  }

  // What Jolt's step took, s, and the bodies' states.
  step(dt, speeds) {
    this.drive(dt, speeds);
    const before = performance.now();
    this.world.Step(dt, 1);
    const answer = [(performance.now() - before) / 1000];
    for (const body of this.bodies) {
      const x = body.GetCenterOfMassPosition();
      answer.push(x.GetX(), x.GetY(), x.GetZ());
      const q = body.GetRotation();
      answer.push(q.GetX(), q.GetY(), q.GetZ(), q.GetW());
      for (const v of [body.GetLinearVelocity(), body.GetAngularVelocity()]) answer.push(v.GetX(), v.GetY(), v.GetZ());
    }
    return answer;
  }

  destroy() {
    Jolt.destroy(this.world);  // with all that is in it
  }
}

const worlds = new Map();
const answer = (message) => {
  let at = 0;
  const next = () => message[at++];
  const what = next(), id = next();
  if (what === 0) {
    worlds.set(id, new World(next));
    return [];
  }
  if (what === 1) return worlds.get(id).step(next(), message.subarray(at));
  worlds.get(id).destroy();
  worlds.delete(id);
  return [];
};
for (;;) write(answer(read()));
