# Finds Bullet in single and in double precision: components single and double,
# targets PintleBullet::single and PintleBullet::double.
#
# Bullet's own targets come first, where its sources are part of the same tree: their precision is the only one.
# Installed libraries are looked for in PINTLE_BULLET_SINGLE_ROOT and PINTLE_BULLET_DOUBLE_ROOT, if given, and nowhere
# else then; otherwise in CMake's default places. (The packages that Bullet installs itself define no targets.)

include(CheckCXXSourceCompiles)
include(FindPackageHandleStandardArgs)

# A name says little about a library's precision, so it must also link: each of these symbols has btScalar in its
# mangled name, one for each library.
set(_pintle_link_check "
  #include <BulletCollision/CollisionShapes/btCapsuleShape.h>
  #include <BulletDynamics/Dynamics/btRigidBody.h>
  #include <LinearMath/btPolarDecomposition.h>
  int main() {
    btPolarDecomposition decomposition(btScalar(1));
    btCapsuleShape shape(btScalar(1), btScalar(1));
    btRigidBody(btScalar(1), nullptr, &shape).setDamping(btScalar(0), btScalar(0));
  }")

function(_pintle_find_bullet precision)
  string(TOUPPER ${precision} PRECISION)
  set(PintleBullet_${precision}_FOUND FALSE PARENT_SCOPE)
  set(libraries BulletDynamics BulletCollision LinearMath)  # static libraries link in this order
  set(definitions "")

  set(in_tree FALSE)
  if(TARGET BulletDynamics)
    get_target_property(imported BulletDynamics IMPORTED)
    if(NOT imported)
      set(in_tree TRUE)
    endif()
  endif()

  if(in_tree)
    # Bullet's targets carry neither include directories nor definitions: both are their directory's.
    get_target_property(source_dir BulletDynamics SOURCE_DIR)
    get_filename_component(include_dir "${source_dir}" DIRECTORY)
    get_directory_property(definitions DIRECTORY "${source_dir}" COMPILE_DEFINITIONS)
    list(FILTER definitions INCLUDE REGEX "^BT_")
    list(REMOVE_DUPLICATES definitions)
    set(tree_precision single)
    if("${definitions}" MATCHES "BT_USE_DOUBLE_PRECISION")
      set(tree_precision double)
    endif()
    if(NOT precision STREQUAL tree_precision)
      return()
    endif()
  else()
    set(root "")
    if(PINTLE_BULLET_${PRECISION}_ROOT)
      set(root PATHS "${PINTLE_BULLET_${PRECISION}_ROOT}" NO_DEFAULT_PATH)
    endif()
    set(suffix "")
    if(precision STREQUAL "double")
      set(suffix -float64)
      set(definitions BT_USE_DOUBLE_PRECISION)
    endif()

    find_path(PINTLE_BULLET_${PRECISION}_INCLUDE_DIR BulletDynamics/ConstraintSolver/btTypedConstraint.h
      ${root} PATH_SUFFIXES bullet include/bullet include)
    set(include_dir "${PINTLE_BULLET_${PRECISION}_INCLUDE_DIR}")
    set(paths "")
    foreach(library IN LISTS libraries)
      set(variable PINTLE_BULLET_${PRECISION}_${library}_LIBRARY)
      # Debian's double precision is named -float64, upstream's as single.
      find_library(${variable} NAMES ${library}${suffix} ${library} ${root}
        PATH_SUFFIXES lib lib64 lib/${CMAKE_LIBRARY_ARCHITECTURE})
      mark_as_advanced(${variable})
      list(APPEND paths "${${variable}}")
    endforeach()
    mark_as_advanced(PINTLE_BULLET_${PRECISION}_INCLUDE_DIR)
    set(libraries ${paths})
    if("${include_dir};${libraries}" MATCHES "NOTFOUND")
      return()
    endif()

    set(CMAKE_REQUIRED_INCLUDES "${include_dir}")
    set(CMAKE_REQUIRED_LIBRARIES ${libraries})
    list(TRANSFORM definitions PREPEND -D OUTPUT_VARIABLE CMAKE_REQUIRED_DEFINITIONS)
    set(CMAKE_REQUIRED_QUIET ${PintleBullet_FIND_QUIETLY})
    check_cxx_source_compiles("${_pintle_link_check}" PINTLE_BULLET_${PRECISION}_LINKS)
    if(NOT PINTLE_BULLET_${PRECISION}_LINKS)
      unset(PINTLE_BULLET_${PRECISION}_LINKS CACHE)  # a repaired Bullet is looked at again
      return()
    endif()
  endif()

  # From 2.89 on a solver of joints may be derived from Bullet's: what the exact solver needs.
  file(STRINGS "${include_dir}/LinearMath/btScalar.h" version REGEX "define BT_BULLET_VERSION")
  string(REGEX MATCH "[0-9]+" version "${version}")
  set(PintleBullet_${precision}_VERSION "${version}" PARENT_SCOPE)
  file(STRINGS "${include_dir}/BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h" convert REGEX "virtual.* convertJoints")
  set(has_exact_solver FALSE)
  if(convert)
    set(has_exact_solver TRUE)
  endif()
  set(PintleBullet_${precision}_EXACT_SOLVER ${has_exact_solver} PARENT_SCOPE)

  if(NOT TARGET PintleBullet::${precision})
    add_library(PintleBullet::${precision} INTERFACE IMPORTED GLOBAL)
    set_target_properties(PintleBullet::${precision} PROPERTIES
      INTERFACE_INCLUDE_DIRECTORIES "${include_dir}"
      INTERFACE_COMPILE_DEFINITIONS "${definitions}"
      INTERFACE_LINK_LIBRARIES "${libraries}")
  endif()
  set(PintleBullet_${precision}_FOUND TRUE PARENT_SCOPE)
endfunction()

set(PintleBullet_PRECISIONS "")
foreach(_precision single double)
  _pintle_find_bullet(${_precision})
  if(PintleBullet_${_precision}_FOUND)
    list(APPEND PintleBullet_PRECISIONS ${_precision})
  endif()
endforeach()

find_package_handle_standard_args(PintleBullet REQUIRED_VARS PintleBullet_PRECISIONS HANDLE_COMPONENTS)
