// Purpose: private members of Bullet's classes, read in the place of getters that round, or that are not const, or not there in
// every version. An explicit instantiation may name them ([temp.spec.general]).
#pragma once

/// Defines `pointer(name())`, the pointer to the private or protected member of a class. For .cpp files, in pintle's namespace
/// without a name: each file has its own.
#define PINTLE_PRIVATE_MEMBER(name, type, of, member) \
  struct name {                                       \
    using Pointer = type of::*;                       \
    friend Pointer pointer(name);                     \
  };                                                  \
  template struct PrivateMember<name, &of::member>

namespace pintle {
namespace {

template <class Name, typename Name::Pointer member>
struct PrivateMember {
  friend typename Name::Pointer pointer(Name) { return member; }
};

}  // namespace
}  // namespace pintle
